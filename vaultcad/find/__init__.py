"""Which vaults stand in a scan: search.py takes it apart, recognise.py tries the families from first_guesses.py,
refine.py fits the best, lunettes.py where it lacks them, reach.py to where its stone ends,
choices.py weighs its arches by likelihood.py and practice.py, no_vault.py doubts it.
identity.py says what makes a family; misfit.py, ridges.py and pockets.py how likely it is that none of them is right,
seen_through.py, footing.py and overlaid.py what else speaks against a vault where it hangs.
"""
