"""Times onnxruntime on the encoder that the kernels are timed on: one photo, one thread.

usage: time_onnxruntime.py MODEL.onnx SKETCH.json

SKETCH.json is the sketch of the kernels, 320 numbers, for the picture whose bytes are ((31 i) >> 4) mod
256. Writes JSON: milliseconds in floating point and in int8 (quantized per channel by onnxruntime's own
tools over pictures by chance), fastest of the rounds, and how far each sketch is from that of the
kernels, in steps of 1/127.
"""

import json
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import onnx
import onnxruntime
from onnxruntime.quantization import CalibrationDataReader, QuantFormat, QuantType, quantize_static

SIDE = 64
ROUNDS, PHOTOS = 200, 10
# Steps that quantized sketches may be off, where onnxruntime chose the scales.
FLOAT_LIMIT, INT8_LIMIT = 16, 64


def main(model, sketch):
    due = np.array(json.loads(Path(sketch).read_text(encoding="utf-8")))
    picture = ((np.arange(SIDE * SIDE * 3) * 31) >> 4) % 256
    photo = as_seen(picture.reshape(SIDE, SIDE, 3))
    with tempfile.TemporaryDirectory() as folder:
        encoder, int8 = Path(folder, "encoder.onnx"), Path(folder, "int8.onnx")
        onnx.utils.extract_model(model, str(encoder), ["photos"], ["sketch", "embedding"])
        quantize_static(
            str(encoder),
            str(int8),
            Pictures(),
            quant_format=QuantFormat.QDQ,
            activation_type=QuantType.QInt8,
            weight_type=QuantType.QInt8,
            per_channel=True,
        )
        milliseconds, difference = timed(encoder, photo, due, FLOAT_LIMIT)
        milliseconds_int8, difference_int8 = timed(int8, photo, due, INT8_LIMIT)
    print(
        json.dumps(
            {
                "version": onnxruntime.__version__,
                "milliseconds": milliseconds,
                "difference": difference,
                "milliseconds_int8": milliseconds_int8,
                "difference_int8": difference_int8,
            }
        )
    )


class Pictures(CalibrationDataReader):
    """Smooth pictures by chance, always the same."""

    def __init__(self):
        chance = np.random.default_rng(1)
        coarse = chance.integers(0, 256, (16, 8, 8, 3))
        fine = coarse.repeat(8, axis=1).repeat(8, axis=2) + chance.integers(-9, 10, (16, SIDE, SIDE, 3))
        self.pictures = iter(np.clip(fine, 0, 255))

    def get_next(self):
        picture = next(self.pictures, None)
        return None if picture is None else {"photos": as_seen(picture)}


def as_seen(picture):
    return ((picture.transpose(2, 0, 1)[None] - 128) / 128).astype(np.float32)


def timed(path, photo, due, limit):
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 4
    session = onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
    cells, _ = session.run(["sketch", "embedding"], {"photos": photo})
    difference = float(np.abs(in_order(np.clip(np.round(cells[0] * 127), -128, 127)) - due).max())
    if difference > limit:
        sys.exit(f"onnxruntime draws another sketch, {difference} steps off")
    fastest = float("inf")
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        for _ in range(PHOTOS):
            session.run(["sketch", "embedding"], {"photos": photo})
        fastest = min(fastest, (time.perf_counter() - begin) / PHOTOS)
    return fastest * 1e3, difference


def in_order(cells):
    """(5, 8, 8) as a sketch has it: covers (16, 16), then details (8, 8)."""
    covers = cells[:4].reshape(2, 2, 8, 8).transpose(2, 0, 3, 1).reshape(-1)
    return np.concatenate([covers, cells[4].reshape(-1)])


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
