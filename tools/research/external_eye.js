// Runs the CenterNet of @vladmandic/human on frames from stdin, and writes one line of JSON a frame to stdout.
//
//   node external_eye.js FOLDER < frames > detections
//
// FOLDER holds node_modules with @vladmandic/human, @tensorflow/tfjs and @tensorflow/tfjs-backend-wasm.
// A frame is 512 x 512 x 3 bytes of RGB. A line is a list of [x0, y0, x1, y1, score, COCO class from 0], in pixels.
'use strict';
const fs = require('fs');
const path = require('path');

const SIDE_PX = 512;
const MIN_SCORE = 0.1;
const modules = path.join(path.resolve(process.argv[2]), 'node_modules');
const tf = require(path.join(modules, '@tensorflow/tfjs'));
const wasm = require(path.join(modules, '@tensorflow/tfjs-backend-wasm'));

async function loadDetector() {
  wasm.setWasmPaths(path.join(modules, '@tensorflow/tfjs-backend-wasm/dist/'));
  await tf.setBackend('wasm');
  await tf.ready();
  const stem = path.join(modules, '@vladmandic/human/models/centernet');
  const graph = JSON.parse(fs.readFileSync(`${stem}.json`));
  const weights = fs.readFileSync(`${stem}.bin`);
  return tf.loadGraphModel({
    load: async () => ({
      modelTopology: graph.modelTopology,
      weightSpecs: graph.weightsManifest.flatMap((part) => part.weights),
      weightData: weights.buffer.slice(weights.byteOffset, weights.byteOffset + weights.byteLength),
      format: graph.format,
      signature: graph.signature,
    }),
  });
}

function readFrame(frame) {
  let filled = 0;
  while (filled < frame.length) {
    const count = fs.readSync(0, frame, filled, frame.length - filled, null);
    if (count === 0) return false;
    filled += count;
  }
  return true;
}

async function main() {
  const model = await loadDetector();
  const frame = Buffer.alloc(SIDE_PX * SIDE_PX * 3);
  while (readFrame(frame)) {
    const image = tf.tidy(() => tf.tensor4d(new Uint8Array(frame), [1, SIDE_PX, SIDE_PX, 3], 'int32').toFloat());
    const output = model.execute(image, ['tower_0/detections']);
    const rows = output.squeeze().arraySync().filter((row) => row[4] >= MIN_SCORE);
    tf.dispose([image, output]);
    fs.writeSync(1, `${JSON.stringify(rows)}\n`);
  }
}

main().catch((error) => {
  console.error(String(error));
  process.exit(1);
});
