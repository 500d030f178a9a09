"""Predictions per second from numpy, and of softfinger.arrays beside them, on one core.

usage: PYTHONPATH=build/release/python python3 tests/python/bench.py
"""

import time
import timeit

import softfinger
from softfinger import arrays
from samples import FAST_MODELS, random_contacts


def fastest_s(call):
    """The least of five, in CPU time: on one core that is the time of an idle machine."""
    times = []
    for _ in range(5):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return min(times)


def bench_arrays(contacts, count, block=100_000):
    """fingertip_layer by the compiled part and by array libraries."""
    print(f"microseconds per contact of fingertip_layer, {count} contacts:")

    def show(name, call):
        print(f"{name:40}{1e6 / count * fastest_s(call):8.2f}", flush=True)

    show("compiled", lambda: softfinger.predict(**contacts, model="fingertip_layer"))
    show("arrays, numpy", lambda: arrays.fingertip_layer(**contacts))
    show("the same with stiffness", lambda: arrays.fingertip_layer(**contacts, with_stiffness=True))
    try:
        import torch
    except ImportError:
        print("arrays, torch: not installed (Debian: python3-torch)")
        return
    torch.set_num_threads(1)
    tensors = {name: torch.asarray(values) for name, values in contacts.items()}
    show("arrays, torch", lambda: arrays.fingertip_layer(**tensors))
    # The record of a million contacts that backward() needs would take 6 GB.
    blocks = [
        {name: x[i : i + block].clone().requires_grad_(True) for name, x in tensors.items()}
        for i in range(0, count, block)
    ]

    def all_derivatives():
        for one in blocks:
            arrays.fingertip_layer(**one).max_torque_Nm.sum().backward()

    show("the same with the torque's derivatives", all_derivatives)


def main(count=1_000_000):
    contacts = random_contacts(count)
    print(f"{'millions per second':20}{'predict':>10}{'gradient':>10}{'bound':>10}")
    for model in FAST_MODELS:
        rates = [
            count / fastest_s(lambda: function(**contacts, model=model)) * 1e-6
            for function in (
                softfinger.predict,
                softfinger.predict_with_gradient,
                softfinger.error_bound,
            )
        ]
        print(f"{model:20}" + "".join(f"{rate:10.2f}" for rate in rates))
    one = {name: float(values[0]) for name, values in contacts.items()}
    print("microseconds of one contact by itself:")
    for function in (softfinger.predict, softfinger.predict_with_gradient, softfinger.error_bound):
        seconds = min(timeit.repeat(lambda: function(**one), number=1000, repeat=5)) / 1000
        print(f"{function.__name__:24}{1e6 * seconds:6.1f}")
    bench_arrays(contacts, count)


if __name__ == "__main__":
    main()
