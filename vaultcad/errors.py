"""What the library raises for input it cannot serve; the command line turns each into one line and exit code 2."""

from __future__ import annotations


class VaultcadError(ValueError):
    """Base of them all; the message names the thing, the value and the way out."""


class NoVaultError(VaultcadError):
    """The scan holds nothing that any family explains."""


class OtherThingError(NoVaultError):
    """What hangs there has the shape of one vault but is another thing, and no part of it is a vault."""


class NoSuchVaultError(VaultcadError):
    """A number that no vault of a model has."""


class ExportError(VaultcadError):
    """A file could not be written, or did not read back as what was meant."""


class ModelFileError(VaultcadError):
    """A model.json that cannot be read, or an edit in it that cannot be."""


class NoSurfaceError(VaultcadError):
    """A vault through whose points no free surfaces can be laid."""


class MissingLibraryError(VaultcadError):
    """A library of the stack, or a system library under it, is missing or broken."""


class DrawingError(VaultcadError):
    """A drawing that cannot be made as it was asked for."""
