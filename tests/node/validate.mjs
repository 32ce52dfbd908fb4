// Prints, as JSON, the issues that the Khronos validator finds in each file named on the command line.
import { readFile } from "node:fs/promises";
import { dirname, resolve } from "node:path";
import validator from "gltf-validator";

const results = {};
for (const file of process.argv.slice(2)) {
  const report = await validator.validateBytes(new Uint8Array(await readFile(file)), {
    uri: file,
    maxIssues: 0,
    externalResourceFunction: async (uri) => new Uint8Array(await readFile(resolve(dirname(file), decodeURIComponent(uri)))),
  });
  results[file] = report.issues.messages
    .filter((message) => message.severity <= 1)
    .map(({ code, severity, pointer, message }) => ({ code, severity, pointer, message }));
}
process.stdout.write(JSON.stringify(results));
