"""Predictions per second from numpy, on one core.

usage: PYTHONPATH=build/release/python python3 tests/python/bench.py
"""

import time
import timeit

import softfinger
from samples import FAST_MODELS, random_contacts


def fastest_s(call):
    """The least of five."""
    times = []
    for _ in range(5):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return min(times)


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


if __name__ == "__main__":
    main()
