#!/usr/bin/env python3
"""tools/ledger.py itself."""
import os
import subprocess
import sys
import tempfile
import unittest

TOOL = os.path.join(os.path.dirname(__file__), "..", "..", "tools", "ledger.py")
HEADER = "effect,setting,metric,value,device,commit\n"


class Ledger(unittest.TestCase):
    def run_tool(self, rows, lines, *options):
        """Exit code, output, and the ledger afterwards, for a ledger with `rows` and a test program that prints `lines`."""
        with tempfile.TemporaryDirectory() as folder:
            ledger, program = os.path.join(folder, "accuracy.csv"), os.path.join(folder, "program")
            with open(ledger, "w", encoding="utf-8") as file:
                file.write(HEADER + "".join(row + "\n" for row in rows))
            with open(program, "w", encoding="utf-8") as file:
                file.write("#!/bin/sh\n" + "".join(f"echo '{line}'\n" for line in lines))
            os.chmod(program, 0o755)
            done = subprocess.run([sys.executable, TOOL, "--ledger", ledger, "--device", "d", *options, program], stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT)
            with open(ledger, encoding="utf-8") as file:
                return done.returncode, done.stdout.decode(), file.read()

    def test_same_within_a_tenth_passes(self):
        code, output, _ = self.run_tool(["glare,default,max,1.0,d,abc"], ["LEDGER,glare,default,max,1.09", "other output"])
        self.assertEqual(code, 0, output)

    def test_worse_by_more_than_a_tenth_fails(self):
        code, output, _ = self.run_tool(["glare,default,max,1.0,d,abc"], ["LEDGER,glare,default,max,1.11"])
        self.assertEqual(code, 1, output)
        self.assertIn("worse: glare default max: 1.11, was 1 at abc", output)

    def test_not_a_number_is_worse(self):
        self.assertEqual(self.run_tool(["glare,default,max,1.0,d,abc"], ["LEDGER,glare,default,max,nan"])[0], 1)

    def test_decibels_the_other_way_round(self):
        rows = ["glare,default,psnr,60,d,abc"]
        self.assertEqual(self.run_tool(rows, ["LEDGER,glare,default,psnr,70"])[0], 0)
        self.assertEqual(self.run_tool(rows, ["LEDGER,glare,default,psnr,50"])[0], 1)

    def test_better_rewrites_its_row_with_update_only(self):
        rows, lines = ["glare,default,max,1.0,d,abc", "glare,default,max,1.0,other,abc"], ["LEDGER,glare,default,max,0.5"]
        self.assertIn("1.0,d,abc", self.run_tool(rows, lines)[2])
        after = self.run_tool(rows, lines, "--update")[2]
        self.assertIn("glare,default,max,0.5,d,", after)
        self.assertIn("glare,default,max,1.0,other,abc", after)

    def test_new_numbers_are_added_with_update(self):
        code, _, after = self.run_tool([], ["LEDGER,tone,a b,mean,2e-7"], "--update")
        self.assertEqual(code, 0)
        self.assertIn("tone,a b,mean,2e-07,d,", after)

    def test_commas_before_blanks_belong_to_the_text(self):
        after = self.run_tool([], ["LEDGER,tone,a, b,mean, rel,2e-7"], "--update")[2]
        self.assertIn('tone,"a, b","mean, rel",2e-07,d,', after)

    def test_a_row_that_nobody_measures_any_more_fails(self):
        self.assertEqual(self.run_tool(["glare,default,max,1.0,d,abc"], [])[0], 1)

    def test_failing_program_gives_no_numbers(self):
        self.assertNotEqual(self.run_tool([], ["LEDGER,a,b"])[0], 0)


if __name__ == "__main__":
    unittest.main()
