# SPDX-License-Identifier: Apache-2.0
"""A system whose files change one after the other is translated as if it were new: no state leaks."""

from __future__ import annotations

from random import Random

import pytest
from test_translate_totality import sound_model
from variations import varied

from fuzz.corpus import Model
from roaml import api
from roaml.jani.writer import write
from roaml.project.settings import Settings
from roaml.project.workspace import Snapshot, Workspace

LARGEST = 12
"""Files. Larger systems say nothing more and take their time."""

STEPS = 12
"""The last one leads back to the model, which is translated again."""


def outcome(snapshot: Snapshot, main: str) -> str | list[tuple[str, int, str]]:
    """The text of the translation, or else the errors."""
    try:
        return "".join(write(api.to_jani(api.loaded(snapshot, main))))
    except api.ModelError as error:
        return [(d.path, d.span.start, d.message) for d in error.result.diagnostics]
    except api.PathError as error:
        return str(error)


def workspace(model: Model) -> Workspace:
    return Workspace((), Settings(ros_paths=model.ros_paths), [model.main])


@pytest.mark.parametrize("seed", range(12))
def test_results_do_not_depend_on_earlier_changes(seed: int) -> None:
    random = Random(seed)
    model = sound_model(random, lambda model: 3 < len(model.texts) < LARGEST)
    lasting = workspace(model)
    for path, text in model.texts.items():
        lasting.open(path, text)
    texts = dict(model.texts)
    for step in range(STEPS):
        back = random.random() < 0.3 or step == STEPS - 1
        texts = dict(model.texts) if back else varied(random, texts)
        for path, text in texts.items():
            lasting.open(path, text)
        new = workspace(model)
        for path, text in texts.items():
            new.open(path, text)
        result = outcome(lasting.snapshot(), model.main)
        assert result == outcome(new.snapshot(), model.main)
        assert isinstance(result, str) or not back
