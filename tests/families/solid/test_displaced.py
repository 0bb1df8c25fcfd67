"""Bodies moved by a smooth displacement: closed, sound, where they belong, and the same when STEP gives them back."""

import numpy as np
import pytest
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepGProp import BRepGProp
from OCP.GeomAbs import GeomAbs_BSplineSurface
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Reader, STEPControl_Writer
from OCP.TopAbs import TopAbs_SHELL
from OCP.TopExp import TopExp_Explorer

from families import FAMILIES, Groin, Pointed
from families.declaration.corners import Skew
from families.solid import brep
from families.solid.displaced import displaced
from families.solid.occ.shapes import faces, is_sound, volume

VAULTS = {cls.id: cls() for cls in FAMILIES} | {
    "skewed": Groin(skew=Skew(shear=0.1, taper_x=-0.05)),
    "pointed": Groin().with_arches({"profile_x": Pointed()}),
}


def settled(points):
    """Waves of some metres, 3 cm high."""
    x, y, z = points.T
    down = -1.3 * np.cos(0.6 * x) * np.cos(0.7 * y + 0.2) - 0.5 * np.sin(z)
    return 0.02 * np.stack([np.sin(1.1 * x + 0.4 * y), np.cos(0.9 * y + 0.7 * z), down], axis=1)


def area(shape):
    sums = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, sums, 1e-7)
    return sums.Mass()


def read_back(shape, path):
    writer = STEPControl_Writer()
    writer.Transfer(shape, STEPControl_AsIs)
    writer.Write(str(path))
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    return reader.OneShape()


@pytest.mark.parametrize("name", VAULTS)
def test_a_displaced_body_is_closed_sound_and_the_same_when_it_is_read_back(name, tmp_path):
    vault = VAULTS[name]
    ideal = brep.masonry(vault, 0.15)
    moved = displaced(ideal, settled)
    assert is_sound(moved)
    shells = TopExp_Explorer(moved, TopAbs_SHELL)
    assert shells.More()
    assert BRep_Tool.IsClosed_s(shells.Current())
    surfaces = [BRepAdaptor_Surface(face).Surface() for face in faces(moved)]
    assert len(surfaces) == len(list(faces(ideal)))
    assert all(s.GetType() == GeomAbs_BSplineSurface for s in surfaces)
    assert not any(s.IsURational() or s.IsVRational() for s in surfaces)
    again = read_back(moved, tmp_path / "moved.step")
    assert is_sound(again)
    assert area(again) == pytest.approx(area(moved), rel=1e-6)


def test_a_body_stands_where_its_displacement_has_it():
    """Of a linear one all sizes are known: stretched by 1, 2 and 3 % its volume grows by their product."""
    ideal = brep.masonry(Groin(), 0.15)
    moved = displaced(ideal, lambda points: points * [0.01, 0.02, 0.03] + [0.5, 0.0, -0.2])
    assert volume(moved) == pytest.approx(1.01 * 1.02 * 1.03 * volume(ideal), rel=1e-6)
