"""All benchmarks in one run: ``make bench``."""

from benchmarks import cart_pole, imports, service

for benchmark in (cart_pole, service, imports):
    benchmark.main()
