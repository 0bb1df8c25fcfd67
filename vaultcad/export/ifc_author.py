"""IFC entities as `ifc` needs them: reproducible GlobalIds, placements, triangulated bodies, properties, quantities."""

from __future__ import annotations

import uuid
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.units import NAMES, unit_of
from vaultcad.export.palette import Colour

Entity = Any  # ifcopenshell has no types

NAMESPACE = uuid.UUID("6f2b9c52-3d0e-5b0c-9c55-6c1d1a9f7e10")  # of all GlobalIds by vaultcad; any fixed value serves
DECIMALS = 6  # of coordinates [m]

# Measure of a property by its unit; plain numbers are reals.
MEASURES = {"m": "IfcLengthMeasure", "rad": "IfcPlaneAngleMeasure", "1": "IfcReal", "share": "IfcRatioMeasure"}
QUANTITIES = {
    "m": ("IfcQuantityLength", "LengthValue"),
    "m2": ("IfcQuantityArea", "AreaValue"),
    "m3": ("IfcQuantityVolume", "VolumeValue"),
}


class Author:
    """Writes into one new IFC4 file; `seed` tells this file's GlobalIds from those of others."""

    def __init__(self, seed: str) -> None:
        import ifcopenshell

        self.file = ifcopenshell.file(schema="IFC4")
        self._made: list[Entity] = []
        self.seed = seed
        self.axes = self.make("IfcAxis2Placement3D", Location=self.point(0.0, 0.0, 0.0))
        self._styles: dict[Colour, Entity] = {}
        self._parts: dict[str, Entity] = {}
        self._units()
        self._contexts()

    def text(self) -> str:
        """The file as it is written; to be asked for once, as nothing is left in it then.

        ifcopenshell 0.9 never gives back what its entities hold, so they are emptied.
        """
        text = str(self.file.to_string())
        for entity in self._made:
            for k in range(len(entity)):
                entity[k] = None
        return text

    def make(self, kind: str, *values: Any, **attributes: Any) -> Entity:
        """An entity that has no identity of its own, or a typed value."""
        self._made.append(self.file.create_entity(kind, *values, **attributes))
        return self._made[-1]

    def root(self, kind: str, key: str, **attributes: Any) -> Entity:
        """An entity with a GlobalId that follows from the file's seed and `key`, which must be unique in the file."""
        import ifcopenshell.guid

        identity = ifcopenshell.guid.compress(uuid.uuid5(NAMESPACE, f"{self.seed}/{key}").hex)
        return self.make(kind, GlobalId=identity, **attributes)

    def point(self, x: float, y: float, z: float) -> Entity:
        """A point [m]."""
        return self.make("IfcCartesianPoint", Coordinates=(float(x), float(y), float(z)))

    def placed(self, parent: Entity | None, matrix: NDArray[np.float64] | None = None) -> Entity:
        """A placement within `parent` by a rigid motion (4, 4), or where the parent is."""
        axes = self.axes
        if matrix is not None:
            z, x = (self.make("IfcDirection", DirectionRatios=matrix[:3, k].tolist()) for k in (2, 0))
            axes = self.make("IfcAxis2Placement3D", Location=self.point(*matrix[:3, 3]), Axis=z, RefDirection=x)
        return self.make("IfcLocalPlacement", PlacementRelTo=parent, RelativePlacement=axes)

    def shape(self, *representations: Entity) -> Entity:
        """Shape of a product."""
        return self.make("IfcProductDefinitionShape", Representations=representations)

    def body(
        self,
        vertices: NDArray[np.float64],
        triangles: NDArray[np.integer],
        colour: Colour,
        identifier: str = "Body",
    ) -> Entity:
        """Representation: a closed triangulated body, vertices (n, 3) [m], triangles (m, 3) turned outwards."""
        points = self.make("IfcCartesianPointList3D", CoordList=(np.round(vertices, DECIMALS) + 0.0).tolist())
        faces = self.make(
            "IfcTriangulatedFaceSet", Coordinates=points, Closed=True, CoordIndex=(triangles + 1).tolist()
        )
        self.make("IfcStyledItem", Item=faces, Styles=(self._style(colour),))
        return self.make(
            "IfcShapeRepresentation",
            ContextOfItems=self._context_of(identifier, "MODEL_VIEW"),
            RepresentationIdentifier=identifier,
            RepresentationType="Tessellation",
            Items=(faces,),
        )

    def footprint(self, rows: Iterable[NDArray[np.float64]]) -> Entity:
        """Shape of a place: closed rows of points (n, 3) [m]."""
        lines = []
        for row in rows:
            corners = [self.point(*point) for point in (np.round(row, DECIMALS) + 0.0).tolist()]
            lines.append(self.make("IfcPolyline", Points=(*corners, corners[0])))
        shape = self.make(
            "IfcShapeRepresentation",
            ContextOfItems=self._context_of("FootPrint", "PLAN_VIEW"),
            RepresentationIdentifier="FootPrint",
            RepresentationType="GeometricCurveSet",
            Items=(self.make("IfcGeometricCurveSet", Elements=lines),),
        )
        return self.shape(shape)

    def value(self, value: bool | int | float | str, unit: str = "1") -> Entity:
        """A typed value: text and truth by themselves, numbers by their unit."""
        match value:
            case bool():
                return self.make("IfcBoolean", value)
            case str():
                return self.make("IfcLabel", value)
            case int():
                return self.make("IfcInteger", value)
        return self.make(MEASURES[unit], float(value))

    def properties(self, element: Entity, name: str, rows: Iterable[tuple[str, Entity, str]]) -> None:
        """A property set of (name, value or enumerated property, meaning) for one element."""
        made = tuple(
            value
            if value.is_a("IfcProperty")
            else self.make("IfcPropertySingleValue", Name=title, Description=meaning or None, NominalValue=value)
            for title, value, meaning in rows
        )
        key = f"{element.GlobalId}/{name}"
        self._define(element, key, self.root("IfcPropertySet", key, Name=name, HasProperties=made))

    def enumerated(self, name: str, value: str, choices: tuple[str, ...], kind: str) -> Entity:
        """A property that takes one of a standard's values."""
        labels = tuple(self.make("IfcLabel", c) for c in choices)
        reference = self.make("IfcPropertyEnumeration", Name=kind, EnumerationValues=labels)
        chosen = (self.make("IfcLabel", value),)
        return self.make(
            "IfcPropertyEnumeratedValue", Name=name, EnumerationValues=chosen, EnumerationReference=reference
        )

    def quantities(self, element: Entity, name: str, values: Mapping[str, tuple[float, str]]) -> None:
        """An element quantity of name -> (value, "m", "m2" or "m3")."""
        made = []
        for title, (value, unit) in values.items():
            kind, attribute = QUANTITIES[unit]
            made.append(self.make(kind, Name=title, **{attribute: round(float(value), DECIMALS)}))
        key = f"{element.GlobalId}/{name}"
        quantity = self.root("IfcElementQuantity", key, Name=name, Quantities=made)
        self._define(element, key, quantity)

    def relate(self, kind: str, key: str, one: tuple[str, Entity], many: tuple[str, Iterable[Entity]]) -> None:
        """A relation from one entity to many, each with the name of its attribute."""
        self.root(kind, key, **{one[0]: one[1], many[0]: tuple(many[1])})

    def _define(self, element: Entity, key: str, definition: Entity) -> None:
        ends = ("RelatingPropertyDefinition", definition), ("RelatedObjects", (element,))
        self.relate("IfcRelDefinesByProperties", f"{key}/rel", *ends)

    def _style(self, colour: Colour) -> Entity:
        if colour not in self._styles:
            red, green, blue = colour.unit
            rgb = self.make("IfcColourRgb", Red=red, Green=green, Blue=blue)
            shading = self.make(
                "IfcSurfaceStyleRendering", SurfaceColour=rgb, Transparency=0.0, ReflectanceMethod="NOTDEFINED"
            )
            self._styles[colour] = self.make("IfcSurfaceStyle", Name=colour.hex, Side="BOTH", Styles=(shading,))
        return self._styles[colour]

    def _units(self) -> None:
        kinds = {"LENGTHUNIT": "METRE", "AREAUNIT": "SQUARE_METRE", "VOLUMEUNIT": "CUBIC_METRE"}
        named = (*kinds.items(), ("PLANEANGLEUNIT", "RADIAN"))
        made = [self.make("IfcSIUnit", UnitType=kind, Name=name) for kind, name in named]
        self.metre = made[0]
        self.units = self.make("IfcUnitAssignment", Units=made)

    def length(self, metres: float) -> Entity:
        """The unit that is so many metres long."""
        if metres == 1:
            return self.metre
        exponents = self.make("IfcDimensionalExponents", 1, 0, 0, 0, 0, 0, 0)
        factor = self.make("IfcMeasureWithUnit", self.make("IfcReal", float(metres)), self.metre)
        unit = unit_of(metres)
        name = NAMES[unit] if unit else f"{metres:.9g} m"
        return self.make("IfcConversionBasedUnit", exponents, "LENGTHUNIT", name, factor)

    def _contexts(self) -> None:
        self.context = self.make(
            "IfcGeometricRepresentationContext",
            ContextType="Model",
            CoordinateSpaceDimension=3,
            Precision=1e-6,
            WorldCoordinateSystem=self.axes,
        )
        for identifier, view in (("Body", "MODEL_VIEW"), ("FootPrint", "PLAN_VIEW")):
            self._context_of(identifier, view)

    def _context_of(self, identifier: str, view: str) -> Entity:
        """The part of the context that representations of one kind are in."""
        if identifier not in self._parts:
            self._parts[identifier] = self.make(
                "IfcGeometricRepresentationSubContext",
                ContextIdentifier=identifier,
                ContextType="Model",
                ParentContext=self.context,
                TargetView=view,
            )
        return self._parts[identifier]
