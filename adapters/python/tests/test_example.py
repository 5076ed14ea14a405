"""The example that compares accelerators: what it prints, and how it ends."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

EXAMPLE = pathlib.Path(__file__).parents[1] / "examples" / "compare.py"


def run(*arguments):
    command = [sys.executable, str(EXAMPLE), "--rays", "300", "--rounds", "1", *arguments]
    return subprocess.run(command, capture_output=True, text=True)


class Example(unittest.TestCase):
    def test_accelerators_stand_in_a_table(self):
        done = run("bumpy:n=12", "--accel", "brute", "--accel", "grid:resolution=8")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        lines = done.stdout.splitlines()
        self.assertEqual(lines[0], "bumpy:n=12: 528 primitives, 300 rays, 1 threads")
        # Brute force takes no step, and tests every primitive for every ray; nothing differs.
        self.assertEqual([lines[2].split()[0], *lines[2].split()[-3:]], ["brute", "0.00", "528.00", "0"])
        self.assertEqual([lines[3].split()[0], lines[3].split()[-1]], ["grid:resolution=8", "0"])

    def test_wrong_input_has_its_exit_code(self):
        with tempfile.TemporaryDirectory() as folder:
            for arguments, code, words in [
                (["bumby"], 2, "did you mean `bumpy`"),
                (["bumpy", "--accel", "netsed"], 2, "did you mean `nested`"),
                (["bumpy", "--threads", "0"], 2, "1 to 1024"),
                ([os.path.join(folder, "none.obj")], 3, "No such file"),
            ]:
                done = run(*arguments)
                self.assertEqual(done.returncode, code, done.stderr)
                self.assertIn(words, done.stderr)
                self.assertNotIn("Traceback", done.stderr)


if __name__ == "__main__":
    unittest.main()
