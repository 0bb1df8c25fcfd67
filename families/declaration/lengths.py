"""Lengths that people measure, in place of the ratios that a family is declared with."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from families.declaration.vault import Vault

RATIOS: dict[str, dict[str, str]] = {
    "sail": {"rise": "rise_ratio"},
    "barrel": {"rise": "rise_ratio"},
    "lunette": {
        "rise": "rise_ratio",
        "pitch": "pitch_ratio",
        "shift": "shift_ratio",
        "lunette_span": "width_ratio",
        "lunette_springing": "springing_ratio",
    },
    "trough": {"rise": "rise_ratio", "south_run": "south_ratio", "north_run": "north_ratio"},
    "mirror": {"run_x": "run_x_ratio", "run_y": "run_y_ratio", "cove_rise": "rise_ratio", "rise": "plane_ratio"},
    "groin": {
        "rise_x": "rise_ratio_x",
        "rise_y": "rise_ratio_y",
        "crown_rise": "crown_rise_ratio",
        "offset_x": "offset_x_ratio",
        "offset_y": "offset_y_ratio",
    },
    "cloister": {"drum_height": "drum_ratio", "rise": "rise_ratio"},
    "conch": {"rise": "rise_ratio"},
    "annular": {"span": "span_ratio", "rise": "rise_ratio"},
    "rib": {"rise": "rise_ratio_diagonal", "rise_x": "rise_ratio_x", "rise_y": "rise_ratio_y"},
    "umbrella": {"rise": "rise_ratio_diagonal", "arch_rise": "rise_ratio"},
    "rotunda": {"drum_height": "drum_ratio", "rise": "rise_ratio"},
    "dome": {"dome_rise": "rise_ratio", "drum_height": "drum_ratio", "pendentive_radius": "pendentive_ratio"},
}
"""Family -> derived length -> the one parameter that it decides, in the order in which they hang on each other."""

ROUNDING = 1e-9  # [m] by which a length may miss what can be had


def with_lengths(vault: Vault, lengths: Mapping[str, float], *, called: Callable[[str], str] = str) -> Vault:
    """The vault with its lengths [m] made as given; each is monotonic in the parameter that it decides.

    `called`: how messages name a length.

    Raises:
        ValueError: a length cannot be had with the other parameters, or its profile leaves it no choice.
    """
    from scipy.optimize import brentq

    for name, ratio in RATIOS[vault.id].items():
        if name not in lengths:
            continue
        wanted, limits = lengths[name], {p.name: p.range for p in vault.parameters()}
        if ratio not in limits:
            fixed = vault.derived_values()[name]
            raise ValueError(
                f"{called(name)} {wanted:g}: its profile makes it {fixed:g} m; choose one that has a rise ratio"
            )

        ends = limits[ratio].low, limits[ratio].high
        least, most = sorted(vault.replaced({ratio: end}).derived_values()[name] for end in ends)
        if not least - ROUNDING <= wanted <= most + ROUNDING:  # not a number either
            raise ValueError(f"{called(name)} {wanted:g}: with the other sizes it can be {least:.6g} to {most:.6g} m")
        goal = min(max(wanted, least), most)

        def above(
            value: float, vault: Vault = vault, name: str = name, ratio: str = ratio, goal: float = goal
        ) -> float:
            return vault.replaced({ratio: value}).derived_values()[name] - goal

        vault = vault.replaced({ratio: brentq(above, *ends, xtol=1e-13)})
    return vault
