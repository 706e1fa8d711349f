"""The Maxwell elements of flexible bodies as arrays."""

from collections.abc import Sequence

import numpy as np

from ...superelement import Chain
from ...superelement.chain import Springs
from ..arrays import Array, as_index, starts
from ..step.records.elastic import Chains


def elements_of(chain: Chain | None) -> int:
    """The number of Maxwell elements."""
    return 0 if chain is None else len(chain.tau)


def hardening_of(chain: Chain | None, h: float, m: int) -> Array:
    """What chains add to the stiffness of m modes in a step, relative to it (m,)."""
    springs = Springs(chain, m)
    springs.set_step(h)
    hardening: Array = np.zeros(m) + springs.hardening
    return hardening


def lay_out_chains(chains: Sequence[Chain | None], n_modes: Sequence[int], h: float) -> Chains:
    """The elements of all flexible bodies, of so many modes each, for a step."""
    chained = [(e, chain) for e, chain in enumerate(chains) if chain is not None and n_modes[e]]
    n_elements = [len(chain.tau) for _, chain in chained]
    n_springs = [n * n_modes[e] for n, (e, _) in zip(n_elements, chained, strict=True)]
    tau = np.concatenate([np.empty(0), *(chain.tau for _, chain in chained)])
    kept, gain = [np.empty(0)], [np.empty(0)]
    for _, chain in chained:
        of_chain = chain.step(h)
        kept.append(of_chain[0])
        gain.append(of_chain[1])
    amplitudes = [chain.amplitudes(n_modes[e]).ravel() for e, chain in chained]
    hardening = [hardening_of(chain, h, m) for chain, m in zip(chains, n_modes, strict=True)]
    return Chains(
        body=as_index([e for e, _ in chained]),
        element=starts(n_elements),
        spring=starts(n_springs)[:-1],
        kept=np.concatenate(kept),
        gain=np.concatenate(gain),
        lost=h / tau,
        amplitude=np.concatenate([np.empty(0), *amplitudes]),
        hardening=np.concatenate([np.empty(0), *hardening]),
    )
