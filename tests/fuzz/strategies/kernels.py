# SPDX-License-Identifier: Apache-2.0
"""Random JANI networks in both kernels of the model checker, number by number."""

from __future__ import annotations

import json
from collections.abc import Iterator
from random import Random

from both_kernels import difference
from fuzz.networks import NetworkCase, network
from fuzz.strategy import Failure, Strategy
from roaml import api
from roaml.jani.reader import read_model
from roaml.json_syntax import parse
from roaml.smc.fault import FaultError

TRACES = 3
STEPS = 25


class Network(NetworkCase):
    def run(self) -> Iterator[Failure]:
        value, syntax = parse(json.dumps(self.written))
        model, findings = read_model(value, "model.jani")
        if syntax or findings or model is None:
            yield Failure("a sound model is not read", "\n".join(finding.message for finding in (*syntax, *findings)))
            return
        try:
            checker = api.checker(model)
        except FaultError:  # it can be told beforehand that it goes wrong
            return
        for scheduler in (0, 1 + self.seed % 97):
            details = difference(checker, checker.compiled_properties[0], self.seed, TRACES, STEPS, scheduler)
            if details:
                yield Failure("the kernels disagree", details)


def make(seed: int) -> Network:
    return Network(seed, network(Random(seed)))


STRATEGY = Strategy("kernels", "runs random JANI networks in both kernels of the model checker", make)
