// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
//     node build.mjs OUTPUT.c
//
// main.js and what it imports become one script, the script a part of shell.html, and that the C array
// ruga_page_shell of view/page.c. The licence of the library stays in it as a comment.
import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import * as esbuild from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const built = await esbuild.build({
  entryPoints: [join(here, "main.js")], bundle: true, minify: true, format: "esm", target: "es2022", write: false,
  legalComments: "inline", logLevel: "warning",
});
const code = built.outputFiles[0].text;
const page = Buffer.from(readFileSync(join(here, "shell.html"), "utf8").replace("/*CODE*/", () => code));
const lines = [];
for (let at = 0; at < page.length; at += 32) lines.push(`${[...page.subarray(at, at + 32)].join(",")},`);
writeFileSync(process.argv[2], `// Written by view/web/build.mjs.
#include "view/page.h"
const size_t ruga_page_shell_size = ${page.length};
const unsigned char ruga_page_shell[] = {
${lines.join("\n")}
};
`);
