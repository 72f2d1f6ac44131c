"""ONNX's checker accepts the networks, and onnxruntime answers as the network in training does.

usage: check_onnx.py [--self-test] DIR
"""

import json

import numpy as np
import onnx
import onnxruntime
from onnx import numpy_helper

from expected import Mismatch, main, require, require_close

# Absolute; relative where values exceed 1.
TOLERANCE = 1e-4


def check(folder):
    states = json.loads((folder / "states.json").read_text(encoding="utf-8"))
    require(states, "states.json names no network")
    for name, due in states.items():
        session = opened(name, lambda: load(folder / name))
        names = {value.name for value in session.get_inputs()}
        for number, state in enumerate(due):
            what = f"{name}: state {number}"
            inputs = {key: array(value) for key, value in state["inputs"].items()}
            outputs = {key: array(value) for key, value in state["outputs"].items()}
            require(names == set(inputs), f"{what}: inputs {sorted(names)} where {sorted(inputs)} are due")
            found = opened(what, lambda: session.run(list(outputs), inputs))
            for (key, expected), got in zip(outputs.items(), found):
                scale = np.maximum(1.0, np.abs(expected))
                require(got.shape == expected.shape, f"{what}: {key} has shape {got.shape}")
                require(np.ptp(expected) > 0.01, f"{what}: {key} is nearly constant, which proves nothing")
                require_close(got / scale, expected / scale, f"{what}: {key}", TOLERANCE)
        shapes = ", ".join(
            "{} views and {} candidates".format(*state["inputs"]["relations"]["shape"][:2])
            for state in due
        )
        require(len(due) > 1, f"{name}: one state alone")
        print(f"{name}: {shapes}")


def load(path):
    onnx.checker.check_model(str(path), full_check=True)
    options = onnxruntime.SessionOptions()
    options.log_severity_level = 4  # what matters is raised too
    return onnxruntime.InferenceSession(
        str(path), options, providers=["CPUExecutionProvider"]
    )


def opened(what, read):
    try:
        return read()
    except Exception as error:  # whatever a reader raises on foreign bytes
        raise Mismatch(f"{what} cannot be run: {str(error).splitlines()[0]}") from None


def array(content):
    return np.array(content["values"], dtype=np.float32).reshape(content["shape"])


def edit(name, change):
    """A fault for `main`: applies `change` to the graph of a network."""

    def fault(folder):
        model = onnx.load(folder / name)
        change(model.graph)
        onnx.save(model, folder / name)

    return fault


def weights(name, change):
    """Applies `change` to a copy of an array of weights."""

    def change_graph(graph):
        tensor = next(tensor for tensor in graph.initializer if tensor.name == name)
        values = numpy_helper.to_array(tensor).copy()
        tensor.CopyFrom(numpy_helper.from_array(change(values), name))

    return change_graph


def nudge(amount):
    def change(values):
        values.flat[0] += amount
        return values

    return change


def node(name, change):
    return lambda graph: change(next(node for node in graph.node if node.name == name))


def attribute(name, values):
    def change(node):
        found = next(attribute for attribute in node.attribute if attribute.name == name)
        found.ints[:] = values

    return change


def rename(operation):
    def change(node):
        node.op_type = operation

    return change


def change_states(change):
    def fault(folder):
        path = folder / "states.json"
        states = json.loads(path.read_text(encoding="utf-8"))
        change(states)
        path.write_text(json.dumps(states), encoding="utf-8")

    return fault


def cut_short(folder):
    path = folder / "poses.onnx"
    path.write_bytes(path.read_bytes()[:-1000])


FAULTS = [
    ("a bias of the ranks off by 5e-4", 0, edit("network.onnx", weights("head_out.bias", nudge(5e-4)))),
    ("a bias of the state off by 5e-4", 0, edit("poses.onnx", weights("state_out.bias", nudge(5e-4)))),
    ("a weight of the encoder off", 0, edit("network.onnx", weights("stem.weight", nudge(0.5)))),
    ("a convolution turned round", 0, edit(
        "network.onnx", weights("stage2.first.weight", lambda w: np.ascontiguousarray(w[..., ::-1])))),
    ("a sketch whose quarters change places", 0, edit(
        "network.onnx", weights("sketch.weight", lambda w: np.ascontiguousarray(w[::-1])))),
    ("outlooks of other candidates", 0, change_states(
        lambda s: s["network.onnx"][0]["inputs"]["outlooks"]["values"].reverse())),
    ("features in another order", 0, edit(
        "poses.onnx", weights("relation.weight", lambda w: np.ascontiguousarray(w[::-1])))),
    ("windows that begin elsewhere", 0, edit(
        "network.onnx", node("stage1.down.sum", attribute("pads", [0, 0, 2, 2])))),
    ("a mean for a maximum", 0, edit("poses.onnx", node("maximum", rename("ReduceMean")))),
    ("a layer without its kink", 0, edit("network.onnx", node("head", rename("Identity")))),
    ("an operation that does not exist", 0, edit("poses.onnx", node("token", rename("Relu7")))),
    ("a network cut short", 0, cut_short),
    ("a missing network", 0, lambda folder: (folder / "network.onnx").unlink()),
    ("another answer", 0, change_states(
        lambda s: s["network.onnx"][1]["outputs"]["ranks"]["values"].__setitem__(7, 0.0))),
    ("another number of views", 0, change_states(
        lambda s: s["poses.onnx"][0]["inputs"]["count"]["values"].reverse())),
]

if __name__ == "__main__":
    main(check, FAULTS, "DIR")
