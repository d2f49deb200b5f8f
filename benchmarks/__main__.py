"""All benchmarks in one run, or those that are named: ``python -m benchmarks [NAME ...]``."""

import argparse
from importlib import import_module

MODULES = {
    "cart_pole": "benchmarks.cart_pole",
    "service": "benchmarks.service",
    "imports": "benchmarks.imports",
    "instructions": "benchmarks.instructions",
    "aims": "benchmarks.aims",
    "sweep": "benchmarks.sweep",
    "growth": "benchmarks.growth",
    "humanoid": "benchmarks.humanoid",
    "contact_step": "benchmarks.contact_step",
    "contact_success": "benchmarks.contact_success",
    "contact_growth": "benchmarks.contact_growth",
    "contact_physics": "benchmarks.contact_physics",
    "contact_snopt": "benchmarks.contact_snopt",
    "mujoco": "benchmarks.against_mujoco",
    "peers": "benchmarks.peers.comparison",
}


def main() -> None:
    """Run what the command line names."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"one of {', '.join(MODULES)}")
    names = parser.parse_args().names
    if unknown := [name for name in names if name not in MODULES]:
        parser.error(f"no benchmark {', '.join(unknown)}; there are {', '.join(MODULES)}")
    for name in names or MODULES:
        import_module(MODULES[name]).main()


if __name__ == "__main__":
    main()
