"""Names of columns in text files, in English, Italian, French, German, Spanish and a little beyond.

In plain words, as `segmentation.units.plain_words` makes them: small letters, no accents or signs, single blanks.
"""

COORDINATES = ("x", "y", "z")
_ALIASES: dict[str, tuple[str, ...]] = {
    "x": (
        "x|easting|eastings|east|e|utm e|utm east|utm easting|grid easting",
        "est|este|ost|leste|oost|ostwert|rechtswert|rechts|oriente",
    ),
    "y": (
        "y|northing|northings|north|n|utm n|utm north|utm northing|grid northing",
        "nord|norte|noord|nordwert|hochwert|hoch",
    ),
    "z": (
        "z|elevation|elev|el|height|h|hgt|level|rl|altitude|alt|ellipsoidal height|orthometric height|z height",
        "hohe nn|hohe nhn|hohe u nn|hohe uber nn|hohe m u nn|gelandehohe",
        "hohe|hoehe|quota|q|altezza|elevazione|hauteur|cote|cota|altitud|elevacion|altura|hoogte",
    ),
    "r": ("r|red|rf|diffuse red|color r|colour r", "rot|rosso|rouge|rojo"),
    "g": ("g|green|gf|diffuse green|color g|colour g", "grun|gruen|verde|vert"),
    "b": ("b|blue|bf|diffuse blue|color b|colour b", "blau|blu|bleu|azul"),
    "nx": ("nx|normalx|normal x|normale x|x normal|normals x",),
    "ny": ("ny|normaly|normal y|normale y|y normal|normals y",),
    "nz": ("nz|normalz|normal z|normale z|z normal|normals z",),
    "intensity": (
        "i|int|intensity|intensities|scalar intensity|reflectance|scalar reflectance|amplitude|return intensity",
        "intensitat|intensitaet|intensita|intensite|intensidad|reflektanz|reflexion|riflettanza|remission",
    ),
    "classification": ("classification|scalar classification|class|klasse|klassifikation|classe|clase",),
    "": (
        "id|ids|point|point id|pointid|point no|point nr|point number|point name|pointname|nr|no|num|number|name|index",
        "idx|count|pt|pt id|pt no|pt nr|ptid|fid|oid|code|label|alpha|a|punkt|punkt nr|punktnr|punktnummer",
        "punkt id|pkt",
        "pktnr|pkt nr|laufnummer|lfd nr|bezeichnung|punto|id punto|nome|numero|num punto|n punto|nombre|numero punto",
        "numero de point|matricule|matr|nom",
    ),
}
NAMES = {alias: name for name, lines in _ALIASES.items() for line in lines for alias in line.split("|")}
"""What a column holds, by its name in plain words; "" is for what a cloud has no use for."""
NORTHERN = {alias for line in _ALIASES["y"] for alias in line.split("|")} - {"y"} | {"h"}
"""Names of a y that does point north; h beside r is a Hochwert."""
NAMES |= {f"points {k}": axis for k, axis in enumerate(COORDINATES)}  # ParaView's
_COORDINATE = ("point", "coordinate", "coord", "coordinata", "coordonnee", "coordenada", "koordinate", "koord")
NAMES |= {f"{word} {axis}": axis for axis in COORDINATES for word in _COORDINATE}
NAMES |= {f"{axis} {word}": axis for axis in COORDINATES for word in _COORDINATE}
NAMES |= {f"{axis}{word}": axis for axis in COORDINATES for word in _COORDINATE}
NAMES |= {f"{word}{axis}": axis for axis in COORDINATES for word in _COORDINATE}
_ANGLES = (
    "lon|long|lng|longitude|longitud|longitudine|lange|laenge|langengrad|laengengrad|geographic longitude",
    "lat|latitude|latitud|latitudine|breite|breitengrad|geographic latitude",
)
GEOGRAPHIC = {name for line in _ANGLES for name in line.split("|")}
"""Names of angles on the globe."""
