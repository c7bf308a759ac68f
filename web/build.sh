#!/usr/bin/env bash
# Make python/mdanim_lammps/view/web/vendor.js, vendor.css and LICENSES.txt anew, or into the folder that is named.
# Needs node and npm; nothing else of this project does.
set -euo pipefail
cd "$(dirname "$0")"
out=$(realpath "${1:-../python/mdanim_lammps/view/web}")
npm ci --silent --no-audit --no-fund
npx esbuild vendor.in.js --bundle --minify --format=esm --target=es2022 --legal-comments=eof --log-level=warning --outfile="$out/vendor.js"
cp node_modules/uplot/dist/uPlot.min.css "$out/vendor.css"
node -e '
const { readFileSync } = require("fs"), { packages } = JSON.parse(readFileSync("package-lock.json"));
console.log("vendor.js and vendor.css are made by web/build.sh from these packages of registry.npmjs.org.\n");
for (const name of ["three", "uplot"]) {
  const { version, integrity } = packages["node_modules/" + name];
  console.log(`${name} ${version}\n${integrity}\n\n${readFileSync(`node_modules/${name}/LICENSE`, "utf8").trim()}\n`);
}' >"$out/LICENSES.txt"
