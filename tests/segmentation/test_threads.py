import subprocess
import sys

FIRST = """
from numba.core.typing.typeof import typeof_impl
import segmentation.voxel
from segmentation.threads import threads
with threads() as pool:
    known = len(typeof_impl.registry)
    list(pool.map(lambda k: segmentation.voxel._bounds(__import__("numpy").zeros((9, 3)), 0, k), range(1, 9)))
    print(known == len(typeof_impl.registry))
"""


def test_no_thread_changes_what_numba_knows_of_types_while_others_look_it_up():
    """Else, once in some hundred runs: dictionary changed size during iteration."""
    said = subprocess.run([sys.executable, "-c", FIRST], capture_output=True, text=True, check=True)
    assert said.stdout == "True\n"
