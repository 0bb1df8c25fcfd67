"""Unpacks the points of a LAZ file to standard output; run by `segmentation.io.laz_apart`, as a program of its own.

A damaged file may take the decoder down, ask for any amount of memory or never end: so this process has limits, and
imports nothing but the decoder.
"""

import contextlib
import json
import os
import sys

CHUNK = 1 << 18  # points at once
SAID = 1 << 16  # bytes that may be written to a file, which is where standard error goes


def limit(memory: int, seconds: int) -> None:
    """Bound memory [bytes] and processor time [s], where the system can; leave no core file, write next to nothing."""
    try:
        import resource
    except ImportError:  # Windows
        return
    for what, most in (
        (resource.RLIMIT_AS, memory),
        (resource.RLIMIT_CPU, seconds),
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_FSIZE, SAID),
    ):
        with contextlib.suppress(ValueError, OSError):
            resource.setrlimit(what, (most, most))


def main(asked: str) -> None:
    """Unpack what the JSON text asks for: path, start of the points, their count and size, record, parts, limits.

    Ends with exit code 1 and the reason on standard error.
    """
    told = json.loads(asked)
    limit(told["memory"], told["seconds"])
    sys.path.append(told["library"])
    import lazrs  # type: ignore[import-untyped,unused-ignore]  # compiled, without stubs

    record, size, left = bytes.fromhex(told["record"]), told["size"], told["count"]
    out = sys.stdout.fileno()
    try:
        if lazrs.LazVlr(record).item_size() != size:
            raise ValueError("records of another size than the header says")
        with open(told["path"], "rb", buffering=1 << 20) as file:
            file.seek(told["start"])
            parts = sum(getattr(lazrs, f"SELECTIVE_DECOMPRESS_{name}") for name in told["parts"])
            decoder = lazrs.ParLasZipDecompressor(file, record, lazrs.DecompressionSelection(parts))
            while left:
                points = bytearray(min(CHUNK, left) * size)
                decoder.decompress_many(points)
                view = memoryview(points)
                while view:
                    view = view[os.write(out, view) :]
                left -= len(points) // size
    except BaseException as error:  # a panic of the decoder is no Exception
        sys.stderr.write(" ".join(f"{type(error).__name__} {error}".split())[:200])
        os._exit(1)


if __name__ == "__main__":
    main(sys.argv[1])
