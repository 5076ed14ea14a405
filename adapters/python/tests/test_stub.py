"""The type stub says what the module has: names, and the signatures that Python sees."""

import ast
import inspect
import pathlib
import unittest

import skipgrid

STUB = ast.parse(pathlib.Path(skipgrid.__file__).with_suffix(".pyi").read_text())


def parameters(function):
    """Names of a stub's parameters with their defaults, as inspect.signature has them."""
    arguments = function.args
    plain = [a.arg for a in arguments.args if a.arg != "self"]
    defaults = [ast.literal_eval(d) for d in arguments.defaults]
    both = list(zip(plain, [inspect.Parameter.empty] * (len(plain) - len(defaults)) + defaults))
    named = [(a.arg, ast.literal_eval(d)) for a, d in zip(arguments.kwonlyargs, arguments.kw_defaults)]
    return both, named


def signature(thing):
    P = inspect.Parameter
    of = [p for p in inspect.signature(thing).parameters.values() if p.name != "self"]
    both = [(p.name, p.default) for p in of if p.kind == P.POSITIONAL_OR_KEYWORD]
    return both, [(p.name, p.default) for p in of if p.kind == P.KEYWORD_ONLY]


class Stub(unittest.TestCase):
    def test_functions_and_methods_have_these_signatures(self):
        accel = next(node for node in STUB.body if isinstance(node, ast.ClassDef) and node.name == "Accel")
        functions = [(skipgrid, node) for node in STUB.body] + [(skipgrid.Accel, node) for node in accel.body]
        checked = set()
        for owner, node in functions:
            if not isinstance(node, ast.FunctionDef):
                continue
            if any(ast.unparse(d) == "property" for d in node.decorator_list):
                self.assertTrue(inspect.isdatadescriptor(getattr(owner, node.name)), node.name)
            elif node.name != "__len__":
                thing = owner if node.name == "__init__" else getattr(owner, node.name)
                self.assertEqual(signature(thing), parameters(node), node.name)
            checked.add(node.name)
        self.assertLessEqual({"__init__", "closest_hit", "bounds", "load", "spheres"}, checked)
        public = {name for name in dir(skipgrid.Accel) if not name.startswith("_")}
        self.assertLessEqual(public, checked)

    def test_everything_public_is_there(self):
        names = {node.target.id for node in STUB.body if isinstance(node, ast.AnnAssign)}
        names |= {node.name for node in STUB.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
        self.assertLessEqual(set(skipgrid.__all__), names)


if __name__ == "__main__":
    unittest.main()
