"""The interpreter lock, threads, signals, and processes that fork."""

import _thread
import multiprocessing
import pickle
import signal
import sys
import threading
import time

import pytest

import femdem


@pytest.fixture(autouse=True)
def interruptible():
    """A shell that starts the tests in its background has them ignore Ctrl-C, for which they would wait."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_other_threads_run_during_one_call_of_step(box_of_stones):
    """Another thread takes turns and then ends the call, which it can only while the lock is free."""
    begin, turns = threading.Event(), []

    def work():
        begin.wait()
        for turn in range(20):
            time.sleep(0.001)
            turns.append(turn)
        _thread.interrupt_main()

    working = threading.Thread(target=work)
    working.start()
    begin.set()
    with pytest.raises(KeyboardInterrupt):
        box_of_stones.step(2_000_000)
    working.join()
    assert len(turns) == 20 and box_of_stones.steps < 2_000_000


def test_a_world_that_steps_is_not_touched_by_others(box_of_stones):
    refused, stop = [], threading.Event()

    def look():
        while not stop.is_set() and not refused:
            try:
                box_of_stones.poses  # noqa: B018
            except RuntimeError as error:
                refused.append(str(error))

    looking = threading.Thread(target=look)
    looking.start()
    while not refused and box_of_stones.steps < 200_000:
        box_of_stones.step(2000)
    stop.set()
    looking.join()
    assert refused and "borrow" in refused[0]


def test_worlds_in_threads_have_the_same_bits(box_of_stones):
    copies = [pickle.loads(pickle.dumps(box_of_stones)) for _ in range(3)]
    threads = [threading.Thread(target=world.step, args=(600,)) for world in copies]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len({world.state_hash() for world in copies}) == 1


def test_ctrl_c_ends_stepping_between_two_steps(box_of_stones):
    threading.Timer(0.3, _thread.interrupt_main).start()
    with pytest.raises(KeyboardInterrupt):
        box_of_stones.step(10**9)
    steps = box_of_stones.steps
    assert steps > 0
    box_of_stones.step(3)
    assert box_of_stones.steps == steps + 3


def test_ctrl_c_ends_a_pack_with_a_checkpoint(tmp_path):
    threading.Timer(1.0, _thread.interrupt_main).start()
    options = {"shape": "dolos", "count": 400, "seed": 1}
    with pytest.raises(KeyboardInterrupt):
        femdem.pack(out=tmp_path / "pack", **options)
    assert (tmp_path / "pack" / "pack.ckpt").is_file()
    assert not (tmp_path / "pack" / "summary.json").exists()


def test_what_a_signal_handler_raises_ends_a_pack(tmp_path):
    class Asked(Exception):
        pass

    def raise_it(*_):
        raise Asked

    before = signal.signal(signal.SIGINT, raise_it)
    try:
        threading.Timer(1.0, _thread.interrupt_main).start()
        with pytest.raises(Asked):
            femdem.pack(out=tmp_path / "pack", shape="dolos", count=400, seed=1)
    finally:
        signal.signal(signal.SIGINT, before)
    assert (tmp_path / "pack" / "pack.ckpt").is_file()


def _hash(data):
    world = pickle.loads(data)
    world.step(300)
    limit = world.stability()
    world.remove([0, 13])
    world.step(10)
    return world.state_hash(), limit


@pytest.mark.skipif(sys.platform == "win32", reason="there is no fork")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_forked_processes_step_too(box_of_stones):
    data = pickle.dumps(box_of_stones)
    here = _hash(data)
    assert here[1] is not None
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(_hash, [data, data]).get(timeout=120) == [here, here]
