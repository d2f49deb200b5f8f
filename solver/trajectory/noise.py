def noisy(t, phase, seed, spread): return t
def noisy_values(v, l, s, sp): return v
