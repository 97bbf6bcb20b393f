"""Endurance and load of the native FMU, in full; tests/test_endurance.py runs the short form.

    python tests/endurance/run.py [--steps 1e8] [--instances 1000] [--kills 50]

Prints a table for each; the exit code tells whether anything was not as it must be.
"""

import argparse
import os
import platform
import resource
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))  # the helpers of the tests

import numpy as np
from endurance.defects import BANDS, EACH, survey
from endurance.energy import PLANS, endure, growths
from endurance.kills import killed, uninterrupted
from endurance.programs import SANITIZERS, program, run, sanitized
from endurance.rotation import DEFECT
from examples import everything
from native_fmu import native_fmu

SIZES = (len(native_fmu(everything).inputs), native_fmu(everything).size)
NEW_SIZES = "40 sizes, not all kept"  # whose coefficients cost ten times the step


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--steps", type=float, default=1e8)
    parser.add_argument("--instances", type=int, default=1000)
    parser.add_argument("--kills", type=int, default=50)
    given = parser.parse_args()
    print(f"{platform.machine()}, {os.cpu_count()} processors, load {os.getloadavg()[0]:.1f} at the start")
    sound = [
        undamped(int(given.steps)),
        coefficients(),
        crowd(given.instances),
        threads(),
        memory(given.instances),
        kills(given.kills),
    ]
    return 0 if all(sound) else 1


def undamped(steps: int) -> bool:
    """Each plan twice, with saves and restores and without; then what each mode did."""
    sound, all_growths = True, {}
    head(
        "8 undamped modes, never saved and a thousand times set back to a saved state;"
        " memory from a tenth of the steps to their end"
    )
    print(
        f"{'steps of':24} {'steps':>9}  {'us/step':>7}  {'same bits':>9}  {'growth/kB':>9}  allocations/save"
    )
    program("undamped")  # compiled
    for plan in PLANS:
        count = steps // 10 if plan == NEW_SIZES else steps
        begin = processor_time()
        plain = endure(plan, count)
        each = (processor_time() - begin) / count * 1e6
        saved = endure(plan, count, saves=1000)
        same = all((plain.motion[k] == saved.motion[k]).all() for k in plain.motion)
        flat = plain.allocations == plain.bytes == plain.left == saved.bytes == saved.left == 0
        sound &= same and flat
        print(
            f"{plan:24} {count:9.0e}  {each:7.3f}  {'yes' if same else 'NO':>9}"
            f"  {plain.resident:4}, {saved.resident:3}  {saved.allocations / 900:.1f}",
            flush=True,
        )
        all_growths[plan] = growths(plain)
    head(
        "The same: ln(energy/energy at 0), phase - omega t in rad; expected: by the rounded coefficients;\n"
        "walk: measured less expected, in standard deviations of as many independent roundings"
    )
    print(
        f"{'steps of':24} {'omega h':>8} {'|det E-1|':>9}  {'ln energy':>10} {'expected':>10} {'walk':>7}"
        f"  {'phase':>10} {'expected':>10} {'walk':>7}"
    )
    for plan, found in all_growths.items():
        for g in found:
            sound &= g.within_bounds
            print(
                f"{plan:24} {g.theta:8.3g} {g.defect:9.1e}  {g.energy:10.2e} {g.energy_expected:10.2e}"
                f" {g.energy_walk:7.1f}  {g.phase:10.2e} {g.phase_expected:10.2e} {g.phase_walk:7.1f}"
            )
    return sound


def coefficients() -> bool:
    head(f"det E - 1 and the turn of a step less omega h, rms (largest), {EACH} modes at random in each band")
    print(
        f"{'omega h':>12}  {'FMU':>17}  {'rounded correctly':>17}  {'cos - 1 kept':>17}"
        f"  {'turn, FMU':>17}  {'rounded correctly':>17}  [1, rad]"
    )
    found = survey()
    for (low, high), x in zip(BANDS, found, strict=True):
        texts = (
            f"{np.sqrt(np.mean(y**2)):.1e} ({np.abs(y).max():.1e})"
            for y in (x.fmu, x.correct, x.increments, x.turn, x.turn_correct)
        )
        print(f"{low:5.3g} .. {high:4.3g}", *(f"{text:>17}" for text in texts), sep="  ")
    return all(np.abs(x.fmu).max() <= DEFECT for x in found)


def crowd(instances: int) -> bool:
    head(f"{instances} instances in one process, 1000 steps each, with inputs, steps and states of their own")
    alone, turns = (
        run(program("crowd"), native_fmu(everything), *SIZES, instances, 1000, 1, how)
        for how in ("alone", "turns")
    )
    same = alone[0] == turns[0] and len(set(turns[0])) == instances + 1
    told = {key: int(value) for key, value in turns[1:]}
    print(f"each equal to the same alone, bit for bit: {'yes' if same else 'NO'}")
    print(f"together {told['bytes'] / 1e6:.1f} MB in {told['blocks']} blocks, {told['left']} left at the end")
    return same and told["left"] == 0


def threads() -> bool:
    head("16 threads, 160 instances, 1000 steps each, under the sanitizers")
    sound = True
    fmu = native_fmu(everything)
    alone = run(program("crowd"), fmu, *SIZES, 160, 1000, 1, "alone")[0]
    print(
        f"as fast as it runs: {verdict(alone, run(program('crowd'), fmu, *SIZES, 160, 1000, 16, 'turns')[0])}"
    )
    for sanitizer in SANITIZERS:
        path = sanitized("crowd", sanitizer)
        if path is None:
            print(f"{sanitizer}: not on this machine")
            continue
        alone = run(path, fmu, *SIZES, 160, 1000, 1, "alone")[0]
        try:
            words = verdict(alone, run(path, fmu, *SIZES, 160, 1000, 16, "turns")[0])
        except RuntimeError as error:
            words, sound = str(error), False
        print(f"{sanitizer}: {words}", flush=True)
        if sanitizer == "ThreadSanitizer":
            seen = reports_a_race(path)
            sound &= seen
            print(f"the control, two threads in one instance: {'reported' if seen else 'NOT SEEN'}")
    return sound


def reports_a_race(path: Path) -> bool:
    """Of threads that step one instance, which FMI forbids, ThreadSanitizer must tell."""
    try:
        run(path, native_fmu(everything), *SIZES, 16, 100, 16, "shared")
    except RuntimeError as error:
        return "data race" in str(error) and "fmi2SetReal" in str(error)
    return False


def verdict(alone: list[str], together: list[str]) -> str:
    return "no report, each as in one thread" if alone == together else "NOT as in one thread"


def memory(rounds: int) -> bool:
    head(f"{rounds} lives of an instance, one after the other, 1000 steps each with sets, gets and states")
    lines = run(program("memory"), native_fmu(everything), *SIZES, rounds, 1000)
    told = {key: int(value) for key, value in lines}
    print(f"grown by {told['resident']} kB from a tenth to the end; at most {told['largest']} bytes out,")
    print(
        f"{told['left']} blocks left; {told['states']} states; {told['inside']} allocations in steps and sets"
    )
    return told["left"] == told["inside"] == 0


def kills(count: int) -> bool:
    steps = 20_000 * count
    head(f"{steps} steps, SIGKILL at {count} random moments, each time resumed by a new process")
    survived = killed(steps, count)
    same = survived.last == uninterrupted(steps)
    print(f"{survived.kills} processes killed, {survived.in_writing} of them while they wrote a state;")
    print(f"the last one began at step {survived.begun[-1]};")
    print(f"equal to an uninterrupted run, bit for bit: {'yes' if same else 'NO'}")
    return same


def processor_time() -> float:
    """Of the programs that have ended, s."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime


def head(title: str) -> None:
    print(f"\n{title}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
