// The programs that the tests run, and where they work. Named by the environment:
//   RUNCERT_BIN            folder of runcert's programs
//   RUNCERT_BROWSER_WORK   folder to work in; what is in it is replaced
//   RUNCERT_NODE_MODULES   folder into which `npm ci` installed this folder's package-lock.json
//   RUNCERT_CHROMIUM       the browser, /usr/bin/chromium where it is not set
//   RUNCERT_STUDY          set: all draws, and not the daily ones alone
import { execFileSync, spawnSync } from "node:child_process";
import { createRequire } from "node:module";
import path from "node:path";
import { fileURLToPath } from "node:url";

function needed(name, what) {
  const value = process.env[name];
  if (!value) throw new Error(`${name} is not set: name the ${what} (see tests/browser/run.sh)`);
  return path.resolve(value);
}

export const sources = fileURLToPath(new URL("../..", import.meta.url));
export const programs = needed("RUNCERT_BIN", "folder of runcert's programs");
export const workFolder = needed("RUNCERT_BROWSER_WORK", "folder to work in");
export const chromiumPath = process.env.RUNCERT_CHROMIUM || "/usr/bin/chromium";

export const isStudy = Boolean(process.env.RUNCERT_STUDY);

const modules = createRequire(path.join(needed("RUNCERT_NODE_MODULES", "folder of npm ci"), "package.json"));
export const { chromium } = modules("playwright-core");
export const axeSource = modules("axe-core").source;

/** Runs a program of runcert; `statuses` are the exit statuses that are right. Its output. */
export function runcert(args, statuses = [0]) {
  const [program, ...rest] = args;
  const done = spawnSync(path.join(programs, program), rest, { encoding: "utf8" });
  if (done.error) throw done.error;
  if (!statuses.includes(done.status))
    throw new Error(`${args.join(" ")}: exit status ${done.status}\n${done.stdout}${done.stderr}`);
  return done.stdout;
}

/** The output of a program of Debian's. */
export const run = (program, ...args) => execFileSync(program, args, { encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
