"""From a scan to a model, stage by stage. Writes segments.laz and vault.step.

`vaultcad fit` does all this at once, and more; example 07 calls the function behind it.
Usage: python examples/06_scan_to_model.py [FOLDER [SCAN]]
"""

import sys
from math import degrees
from pathlib import Path

import numpy as np

from families import Barrel, Groin, Sail
from segmentation import read, write_labelled
from vaultcad.find.recognise import confidence, recognise
from vaultcad.find.refine import refine
from vaultcad.fit.label import label
from vaultcad.measure.as_built import displacement
from vaultcad.measure.deviation import summarise
from vaultcad.measure.routes import as_built_distance
from vaultcad.mechanisms import Body
from vaultcad.survey.thinned_scan import survey

ROOM = Path(__file__).with_name("room.laz")


def main(out: Path, scan: Path = ROOM) -> None:
    rng = np.random.default_rng(0)
    cloud = read(scan)

    # Find the room: thinned points with normals, the plan, what stands above the floor.
    site = survey(cloud)
    print(f"plan {site.spans[0]:.2f} x {site.spans[1]:.2f} m, {len(site.points):,} points {site.spacing:.3f} m apart")

    # Which family is it? Three of the seven compete here; leave `families` out for all of them.
    hypotheses = recognise(site, rng, families=(Sail, Barrel, Groin))
    for hypothesis, share in zip(hypotheses, confidence(hypotheses), strict=True):
        print(f"{hypothesis.vault.title:14} score {hypothesis.score:10.1f}, confidence {share:.3f}")

    # Fit all parameters and the pose of the winner together.
    refined = refine(hypotheses[0], site, rng)
    vault, pose = refined.placed.vault, refined.placed.pose
    print(f"{vault}, turned by {degrees(pose.yaw):.2f}°")

    # Label every point of the scan, and say how far the stone is from the model.
    labels = label(cloud.xyz, [(refined.placed, 4 * refined.scatter)])
    on = labels.component > 0
    ideal = summarise(labels.deviation[on])
    print(f"{on.sum():,} points of the vault, rms {1000 * ideal.rms:.1f} mm, {ideal.loa}")

    # The stone as it stands: a smooth displacement of the ideal vault, from every tenth of its points.
    frame = pose.frame()
    local = cloud.xyz[on] @ frame[:, :3].T + frame[:, 3]
    normal, distance = vault.evaluate(local).normal, labels.deviation[on].astype(np.float64)
    foot = local - distance[:, None] * normal
    surface = displacement(foot[::10], normal[::10], distance[::10], Body.of(vault))
    rest = summarise(as_built_distance(vault, surface, local))
    print(f"as built: rms {1000 * rest.rms:.1f} mm")

    write_labelled(scan, out / "segments.laz", cloud, {"component": labels.component, "deviation": labels.deviation})

    from build123d import Location, export_step

    solid = vault.solid(thickness=0.15).moved(
        Location((1000 * pose.x, 1000 * pose.y, 1000 * pose.z), (0, 0, degrees(pose.yaw)))
    )
    export_step(solid, out / "vault.step")


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out")
    folder.mkdir(parents=True, exist_ok=True)
    main(folder, *map(Path, sys.argv[2:3]))
