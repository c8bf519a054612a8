# SPDX-License-Identifier: Apache-2.0
"""The parts of script/gpu-check that the emulated GPU does not reach: compilers and GPUs that are too old, tools that are not
there or do not work, steps that fail or hang; and what its tables are made of. Programs are pretended by scripts."""

import contextlib
import io
import os
import sys
import tempfile
import time
import unittest
from pathlib import Path

SOURCE = Path(os.environ["STANDOFF_SOURCE_DIR"])
sys.path.insert(0, str(SOURCE / "bench"))
import gpu_build  # noqa: E402
import gpu_jobs  # noqa: E402
import gpu_steps  # noqa: E402
import gpu_tables  # noqa: E402
from gpu_build import Unfit  # noqa: E402

HEAD = ("table,scene,triangles,method,output,grid,thickness,median_ms,least_ms,runs,samples_examined,samples_band,"
        "list_entries,workspace_mib,written_gb_per_s,seconds_2008,at_most_ms")
ROW = "goal,{},1,tiles,dense,{},{},1.5,1.4,5,1,1,1,1,1,-,-"


def quiet(work, *arguments):
    """Its result, and what it printed."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        result = work(*arguments)
    return result, said.getvalue()


def ends(state):
    """Whether a process, killed but perhaps not gone, is so within ten seconds."""
    for _ in range(1000):
        try:
            if state.read_text().split()[2] == "Z":
                return True
        except OSError:
            return True
        time.sleep(0.01)
    return False


def quiet_stdout():
    return contextlib.redirect_stdout(io.StringIO())


class Pretended(unittest.TestCase):
    """A folder of results, one of programs, and the tools of a machine."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.out, self.build, self.tools = (Path(self.folder.name) / name for name in ("out", "build", "tools"))
        for folder in (self.out, self.build, self.tools):
            folder.mkdir()
        self.path = os.environ["PATH"]
        os.environ["PATH"] = f"{self.tools}:{self.path}"
        self.steps = gpu_steps.Steps(self.out, self.build)

    def tearDown(self):
        os.environ["PATH"] = self.path
        self.folder.cleanup()

    def program(self, path, text):
        path.write_text(f"#!/bin/bash\n{text}\n")
        path.chmod(0o755)

    def pretend(self, check="echo '0 of 1 checks went wrong'", check_collide="echo '0 of 1 checks went wrong'",
                measure="cat >/dev/null", **tools):
        self.program(self.build / "check", check)
        self.program(self.build / "check_collide", check_collide)
        self.program(self.build / "measure", measure)
        for name, text in tools.items():
            self.program(self.tools / name.replace("_", "-"), text)


class Building(unittest.TestCase):
    def test_architectures_are_looked_up(self):
        of_12_8 = "compute_75\ncompute_80\ncompute_90\ncompute_90a\ncompute_100\ncompute_120\n"
        self.assertEqual(gpu_build.architecture_for("9.0", of_12_8), "90")
        # Below the newest, 12.0, and yet unknown: no code for 12.0 runs on it, that for 10.0 does.
        self.assertEqual(gpu_build.architecture_for("10.3", of_12_8), "100")
        self.assertEqual(gpu_build.architecture_for("13.0", of_12_8), "120")
        self.assertEqual(gpu_build.architecture_for("", of_12_8), "120")
        with self.assertRaisesRegex(Unfit, "compute capability 7.0, this nvcc compiles for 7.5 and newer"):
            gpu_build.architecture_for("7.0", of_12_8)

    def test_old_compilers_are_named(self):
        said = "Cuda compilation tools, release {}, V{}.1\n"
        for version in ("12.0", "12.8", "13.0"):
            gpu_build.expect_new_enough(said.format(version, version))
        with self.assertRaisesRegex(Unfit, "nvcc 11.8 is too old"):
            gpu_build.expect_new_enough(said.format("11.8", "11.8"))

    def test_what_kernels_take(self):
        log = """ptxas info    : 0 bytes gmem
ptxas info    : Compiling entry function '_Z4fastv' for 'sm_90'
ptxas info    : Function properties for _Z4fastv
    0 bytes stack frame, 0 bytes spill stores, 0 bytes spill loads
ptxas info    : Used 12 registers, used 0 barriers
[2/3] Building CUDA object
ptxas info    : Compiling entry function '_Z4slowv' for 'sm_90'
ptxas info    : Function properties for _Z4slowv
    48 bytes stack frame, 44 bytes spill stores, 40 bytes spill loads
ptxas info    : Used 64 registers, used 1 barriers, 48 bytes cumulative stack size, 27784 bytes smem
"""
        slow, fast = gpu_build.kernels_of(log)
        self.assertEqual((slow["registers"], slow["spill_store_bytes"], slow["spill_load_bytes"], slow["shared_bytes"]),
                         (64, 44, 40, 27784))
        self.assertEqual(gpu_build.short_name("void standoff::cuda::gather<true, standoff::cuda::AllSteps>(standoff::Lattice, int)"),
                         "gather<true, AllSteps>")
        self.assertEqual(gpu_build.short_name("cub::Scan<a, f<(int)3> >(int const*)"), "cub::Scan")
        self.assertEqual((fast["registers"], fast["shared_bytes"], fast["architecture"]), (12, 0, "sm_90"))


class Stepping(Pretended):
    def test_a_step_that_fails_does_not_stop_the_next(self):
        self.pretend(check="echo 'WRONG  tiles'; exit 7", measure="cat >/dev/null; exit 1")
        _, said = quiet(self.steps.run, ["goals", "check"])
        self.assertEqual(len(self.steps.problems), 2)
        self.assertIn("WRONG  tiles", said)
        self.assertIn("check: exit code 7; see", said)
        self.assertIn("0 of 1 checks", (self.out / "collide.txt").read_text())
        self.assertEqual([line.split(",")[::2] for line in (self.out / "steps.csv").read_text().splitlines()[1:]],
                         [["measure the goals", "1"], ["check", "7"], ["check_collide", "ok"]])

    def test_a_step_that_hangs_ends_with_all_that_it_started(self):
        child = self.out / "child"
        self.program(self.build / "hangs", f"echo begun; sleep 1000 & echo $! >{child}; wait")
        went_well, said = quiet(self.steps.step, "hanging", [self.build / "hangs"], 0.5, self.out / "hangs.txt")
        self.assertFalse(went_well)
        self.assertIn("hanging: took over 0.5 s", said)
        self.assertEqual((self.out / "hangs.txt").read_text(), "begun\n")
        self.assertTrue(ends(Path(f"/proc/{child.read_text().strip()}/stat")))

    def test_a_gpu_that_cannot_be_used_ends_all(self):
        self.pretend(measure="echo table,scene; echo 'cuda: no NVIDIA driver' >&2; exit 6")
        said = io.StringIO()
        with self.assertRaisesRegex(Unfit, "the GPU cannot be used"), contextlib.redirect_stderr(said), quiet_stdout():
            self.steps.run(["goals", "check"])
        self.assertIn("cuda: no NVIDIA driver", said.getvalue())
        self.assertFalse((self.out / "check.txt").exists())

    def test_jobs_are_measured_once(self):
        jobs = gpu_jobs.goal_jobs()
        rows = [ROW.format(job.scene, "x".join(map(str, job.size)), f"{job.thickness:g}") for job in jobs]
        cut_off = rows[3][:20]
        (self.out / "gpu.csv").write_text("\n".join([HEAD, rows[0], rows[2], cut_off]) + "\n")
        asked = self.out / "asked"
        self.pretend(measure=f"echo \"$@\" >{asked}; cat >>{asked}; echo '{rows[1]}'")
        quiet(self.steps.run, ["goals"])
        self.assertEqual(asked.read_text().splitlines(), ["--continue", *(jobs[n].line() for n in (1, 3, 4, 5))])
        self.assertEqual((self.out / "gpu.csv").read_text().splitlines(), [HEAD, rows[0], rows[2], cut_off, rows[1]])

    def test_the_sanitizer(self):
        asked = self.out / "asked"
        self.pretend(compute_sanitizer=f"echo \"$*\" >>{asked}; echo '========= ERROR SUMMARY: 0 errors'; "
                                       "[[ $* != *racecheck*check_collide* ]] || exit 9")
        _, said = quiet(self.steps.run, ["sanitize"])
        self.assertEqual(len(asked.read_text().splitlines()), 8)
        for tool in ("memcheck", "racecheck", "initcheck", "synccheck"):
            self.assertIn(f"== {tool} check_collide", (self.out / "sanitizer.txt").read_text())
        self.assertEqual(len(self.steps.problems), 1)
        self.assertIn("racecheck of check_collide found something", said)
        self.assertRegex(asked.read_text(), "initcheck .*check --quick --unpoisoned")

    def test_a_sanitizer_that_does_not_work_is_no_fault(self):
        self.pretend(compute_sanitizer="echo '========= Error: Device not supported'; exit 1")
        _, said = quiet(self.steps.run, ["sanitize"])
        self.assertIn("does not work on this machine", said)
        self.assertEqual(self.steps.problems, [])

    def test_profiles(self):
        self.pretend(ncu="if [[ $1 == --import ]]; then echo details of $2; else while [[ $1 != --export ]]; do shift; done; "
                         "touch $2; fi")
        quiet(self.steps.profile)
        self.assertEqual(sorted(path.name for path in self.out.glob("profile-*")),
                         [f"profile-{scene}.{kind}" for scene in ("catapult", "factory", "terrain") for kind in ("ncu-rep", "txt")])
        self.pretend(ncu="echo '==ERROR== LibraryNotLoaded'; exit 1")
        _, said = quiet(self.steps.profile)
        self.assertIn("ncu did not work (==ERROR== LibraryNotLoaded)", said)
        self.assertEqual(self.steps.problems, [])


class Tables(unittest.TestCase):
    def test_every_prediction_is_of_a_job(self):
        jobs = {job.key() for job in [*gpu_jobs.goal_jobs(), *gpu_jobs.own_jobs()]}
        predicted = gpu_jobs.rows_of(SOURCE / "bench/gpu_predictions.csv")
        self.assertGreater(len(predicted), 5)
        for row in predicted:
            self.assertIn(tuple(row[name] for name in ("table", "scene", "method", "output", "grid", "thickness")), jobs)
            self.assertLess(float(row["ms_from"]), float(row["ms_to"]))

    def test_predictions_stand_beside_what_was_measured_on_their_gpu_alone(self):
        row = dict(zip(HEAD.split(","), ROW.format("catapult", "412x404x416", "2").split(",")))
        shown = gpu_tables.goals([row], [], gpu_tables.predictions("name\nNVIDIA H200, 580.1\nstandoff: c863e91\n"))
        self.assertEqual((shown[0]["ms"], shown[0]["predicted"]), ("1.5", "1.25-1.6"))
        self.assertNotIn("predicted", gpu_tables.goals([row], [], gpu_tables.predictions("the emulated GPU"))[0])
        self.assertNotIn("predicted", gpu_tables.goals([row], [], gpu_tables.predictions("NVIDIA H200\nstandoff: other"))[0])

    def test_peers_stand_beside_the_jobs_that_they_do(self):
        row = dict(zip(HEAD.split(","), ROW.format("sphere", "32x32x32", "inf").split(",")))
        peer = {"job": "sphere-inf-32", "query": "mesh_query_point", "median_ms": str(4 * float(row["median_ms"]))}
        for output, ratio in (("dense", "4"), ("signed", "4"), ("sparse", "")):
            shown = gpu_tables.goals([{**row, "output": output}], [peer], {})
            self.assertEqual(shown[0]["Warp, times as long"], ratio)
        self.assertEqual(gpu_tables.goals([{**row, "grid": "64x64x64"}], [peer], {})[0]["Warp, times as long"], "")

    def test_table_5_4_is_of_differences(self):
        rows = [{"table": "table_5.4", "method": "tiles", "output": output, "median_ms": ms}
                for output, ms in (("dense", "5"), ("counting", "0.5"), ("through_lists", "0.75"))]
        self.assertEqual([(part["part"], part["ms"]) for part in gpu_jobs.table_5_4(rows)],
                         [("all", "5"), ("counting", "0.5"), ("listing", "0.25")])


if __name__ == "__main__":
    unittest.main()
