"""The nonlinear program: variables, stage groups, assembly, scaling and what is wrong with it."""
