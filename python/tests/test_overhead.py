"""What Python adds to a call, and an import to the start of a program: by what they do. The time it takes is printed, since a busy
machine triples it."""

import subprocess
import sys
import time

import phicam


def work(call):
    """The instructions of the interpreter that one call takes, after a call that loads what it needs."""
    call()
    instructions = 0

    def count(frame, event, _argument):
        nonlocal instructions
        frame.f_trace_opcodes = True
        instructions += event == "opcode"
        return count

    traced = sys.gettrace()
    sys.settrace(count)
    try:
        call()
    finally:
        sys.settrace(traced)
    return instructions


def took(call):
    """The least time of the processor that the calling thread takes, ms: the crate computes in other threads."""
    least = float("inf")
    for _ in range(5):
        begun = time.thread_time()
        call()
        least = min(least, 1e3 * (time.thread_time() - begun))
    return least


def test_a_call_does_as_much_whatever_the_size():
    """Arrays in and out, checks, threads, and what is made of the result: no loop over entries, spots or elements.
    Five thousand instructions are some 0.2 ms."""
    instructions = []
    for pixels, per_side in (4, 3), (16, 30):
        scene = phicam.Scene("bench").replace({"camera.pixels": (pixels, pixels), "laser.spots.per_side": per_side})
        phi, model = phicam.render(scene, samples=32), phicam.model(scene)
        assert phi.shape == (pixels**2, 4 * per_side)
        calls = {
            "render": lambda scene=scene: phicam.render(scene, samples=32),
            "model": lambda scene=scene: phicam.model(scene),
            "recover": lambda phi=phi, model=model: phicam.recover(phi, model, "tsvd"),
        }
        instructions.append({name: work(call) for name, call in calls.items()})
        print(phi.shape, {name: f"{took(call):.2f} ms of the caller" for name, call in calls.items()}, instructions[-1])
    assert instructions[0] == instructions[1]
    assert max(instructions[1].values()) < 5_000


def test_import_loads_nothing_but_numpy():
    """Beside NumPy and its parts, only modules of its own and of the standard library."""
    program = "import sys, numpy; before = set(sys.modules); import phicam; print(*set(sys.modules) - before)"
    loaded = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True).stdout.split()
    foreign = {name.partition(".")[0] for name in loaded} - set(sys.stdlib_module_names) - {"phicam", "numpy"}
    print(len(loaded), "modules beside NumPy's")
    assert "phicam._native" in loaded
    assert not foreign
    assert len(loaded) < 100
