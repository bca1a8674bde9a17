"""The interpreter lock, threads, signals, and processes that fork."""

import _thread
import multiprocessing
import pickle
import sys
import threading
import time

import pytest

import femdem


def test_other_threads_run_while_a_world_steps(box_of_stones):
    done = threading.Event()

    def work():
        while not done.is_set():
            box_of_stones.step(200)

    stepping = threading.Thread(target=work)
    stepping.start()
    # This loop makes progress only if the lock is released during the steps.
    turns = 0
    while turns < 20:
        time.sleep(0.001)
        turns += 1
    done.set()
    stepping.join()
    assert box_of_stones.steps >= 200


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


def _hash(data):
    world = pickle.loads(data)
    world.step(300)
    return world.state_hash()


@pytest.mark.skipif(sys.platform == "win32", reason="there is no fork")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_forked_processes_step_too(box_of_stones):
    data = pickle.dumps(box_of_stones)
    here = _hash(data)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map(_hash, [data, data]) == [here, here]
