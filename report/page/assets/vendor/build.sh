#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes uplot.min.js, uplot.min.css, three.min.js and the licences anew from what npm installed here.
set -euo pipefail
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"

cp node_modules/uplot/dist/uPlot.iife.min.js uplot.min.js
cp node_modules/uplot/dist/uPlot.min.css uplot.min.css
cp node_modules/uplot/LICENSE uplot.LICENSE
cp node_modules/three/LICENSE three.LICENSE
node_modules/.bin/esbuild three_entry.js --bundle --minify --format=iife --global-name=Three \
  --target=es2020 --charset=ascii --legal-comments=inline --outfile=three.min.js
