"""What a program pays that only reads a file through obspy: a reader, and none of Kouros's compilers or validators."""

import subprocess
import sys

READ = """
import sys, warnings
warnings.simplefilter("ignore")
import obspy
(trace, *_) = obspy.read(sys.argv[1])
print(trace.stats.kouros.units, *(name for name in ("numba", "pydantic", "sqlalchemy") if name in sys.modules))
"""


def test_reading_loads_no_compiler(tmp_path):
    file = tmp_path / "record.csv"
    rows = [f"{0.01 * i:.2f}, {0.1 * (i % 7)}" for i in range(50)]
    file.write_text("\n".join(["# processed: yes", "time (s), HNE (cm/s2)", *rows]) + "\n")
    done = subprocess.run([sys.executable, "-c", READ, str(file)], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["cm/s2"]
