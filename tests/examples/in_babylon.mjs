// Loads an avatar into Babylon without a screen; prints its shapes, and where chosen ones move it.
// node in_babylon.mjs MODULES AVATAR MESH SHAPE ...: MODULES is a node_modules folder.
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import { pathToFileURL } from "node:url";

const [modules, avatar, name, ...shapes] = process.argv.slice(2);
const find = createRequire(path.join(modules, "page.js"));
const load = (file) => import(pathToFileURL(find.resolve(file)).href);
const { LoadAssetContainerAsync, Logger, NullEngine, Scene } = await load("@babylonjs/core");
await load("@babylonjs/loaders/glTF/index.js");
Logger.LogLevels = Logger.ErrorLogLevel;
const engine = new NullEngine();
const data = new Uint8Array(fs.readFileSync(avatar));
const options = { pluginExtension: ".glb" };
const found = await LoadAssetContainerAsync(data, new Scene(engine), options);
const mesh = found.meshes.find((each) => each.name === name);
const manager = mesh.morphTargetManager;
const targets = [...Array(manager.numTargets).keys()].map((number) => manager.getTarget(number));
const places = { rest: Array.from(mesh.getPositionData(false, true)) };
for (const target of targets.filter((each) => shapes.includes(each.name))) {
  target.influence = 1;
  places[target.name] = Array.from(mesh.getPositionData(false, true));
  target.influence = 0;
}
const nodes = found.transformNodes.map((each) => each.name);
console.log(JSON.stringify({ names: targets.map((each) => each.name), nodes, places }));
engine.dispose();
