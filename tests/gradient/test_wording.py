import pytest

from vaso.gradient.wording import value_text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (True, "true"),
        (None, "unknown"),
        (10.0, "10"),
        (1.118033988749895, "1.118034"),
        (1.0000004, "1.0000004"),
        (0.30000000000000004, "0.3"),
        (123456.789, "123456.789"),
        (-0.5, "-0.5"),
    ],
)
def test_values(value: float | bool | None, text: str) -> None:
    assert value_text(value) == text
