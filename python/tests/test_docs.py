"""Examples in the documentation run, and the stubs say what there is."""

import ast
import doctest
import inspect
import pathlib
import sys

import pytest

import umbrage
from umbrage import _umbrage, strategies

HERE = pathlib.Path(__file__).resolve().parent
STUBS = pathlib.Path(umbrage.__file__).with_name("_umbrage.pyi")


def run(name, text, **names):
    """Runs the examples of a text; how many there are."""
    test = doctest.DocTestParser().get_doctest(text, {"umbrage": umbrage, **names}, name, None, 0)
    said = []
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS)
    runner.run(test, out=said.append)
    assert not runner.failures, "".join(said)
    return len(test.examples)


FUNCTIONS = [name for name, value in vars(_umbrage).items() if callable(value) and not name.startswith("_")]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_examples_of_each_function_run(name):
    assert run(name, inspect.getdoc(getattr(umbrage, name))) > 0


@pytest.mark.parametrize("module", [umbrage.shapes, strategies], ids=["shapes", "strategies"])
def test_examples_of_a_module_run(module):
    for name in module.__all__:
        run(name, inspect.getdoc(getattr(module, name)) or "", **vars(module))


def test_examples_of_the_readme_run():
    readme = HERE.parent / "README.md"
    assert run("README.md", readme.read_text(encoding="utf-8").replace("```", "")) >= 10


def test_an_example_that_is_wrong_fails():
    with pytest.raises(AssertionError):
        run("wrong", ">>> umbrage.Verdict.LIT + 1\n0\n")


def signature_of(function):
    """Names, kinds and defaults as text."""
    return [
        (p.name, p.kind.name, "" if p.default is p.empty else repr(p.default))
        for p in inspect.signature(function).parameters.values()
        if p.name != "self"
    ]


def stub_of(node):
    args = node.args
    plain = args.posonlyargs + args.args
    defaults = [None] * (len(plain) - len(args.defaults)) + args.defaults
    every = [(a, "POSITIONAL_OR_KEYWORD", d) for a, d in zip(plain, defaults)]
    every += [(a, "KEYWORD_ONLY", d) for a, d in zip(args.kwonlyargs, args.kw_defaults)]
    return [
        (a.arg, kind, "" if d is None else repr(ast.literal_eval(d)))
        for a, kind, d in every
        if a.arg not in ("self", "cls")
    ]


def test_stubs_have_the_signatures_that_there_are():
    tree = ast.parse(STUBS.read_text(encoding="utf-8"))
    stubs = {node.name: node for node in tree.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    assert set(stubs) == set(FUNCTIONS)
    functions = {name: node for name, node in stubs.items() if isinstance(node, ast.FunctionDef)}
    for name, node in functions.items():
        assert stub_of(node) == signature_of(getattr(_umbrage, name)), name
    members = {node.name: node for node in stubs["Oracle"].body if isinstance(node, ast.FunctionDef)}
    there = {name for name in vars(_umbrage.Oracle) if not name.startswith("_")}
    assert set(members) - {"__new__"} == there
    for name in ["verdicts", "visible_fraction"]:
        assert stub_of(members[name]) == signature_of(getattr(_umbrage.Oracle, name)), name
    if sys.version_info >= (3, 10):  # where classes have signatures
        assert stub_of(members["__new__"]) == signature_of(_umbrage.Oracle)


def test_everything_has_a_docstring_and_results_say_their_shapes():
    for name in umbrage.__all__:
        assert inspect.getdoc(getattr(umbrage, name)), name
    for name in FUNCTIONS:
        assert "shape (" in inspect.getdoc(getattr(umbrage, name)) or name == "check"


def test_version_is_that_of_the_crate():
    manifest = (HERE.parents[1] / "Cargo.toml").read_text(encoding="utf-8")
    assert f'\nversion = "{umbrage.__version__}"\n' in manifest


def test_typed_package_says_so():
    assert STUBS.exists() and STUBS.with_name("py.typed").exists()
