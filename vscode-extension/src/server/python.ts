// SPDX-License-Identifier: Apache-2.0
import type { Host } from "./host";
import { isInside } from "./surroundings";

/** The oldest Python that the server runs on. */
export const OLDEST: readonly [number, number] = [3, 10];

const NAMES = ["python3", "python3.13", "python3.12", "python3.11", "python3.10", "python"];

const PRINT_PYTHON =
    "import sys\n" +
    "print(sys.executable, *sys.version_info[:2], sep='\\n')\n" +
    "try:\n" +
    "    from importlib.metadata import version\n" +
    "    print(version('as2fm-lsp'))\n" +
    "except Exception:\n" +
    "    pass\n";

const TIMEOUT_MS = 20_000;

export interface Python {
    readonly executable: string;
    readonly version: string;
    readonly recent: boolean;
    /** The version of the server that is installed in its environment. */
    readonly server: string | undefined;
}

/** The properties of a Python interpreter, as it reports them; undefined if the program is not one. */
export async function askPython(host: Host, executable: string): Promise<Python | undefined> {
    // -I: imports depend neither on the working folder nor on environment variables.
    const ended = await host.run(executable, ["-I", "-c", PRINT_PYTHON], { timeout: TIMEOUT_MS });
    const [path, major, minor, server] = ended.out.split(/\r?\n/);
    if (ended.status !== 0 || !path || !major || !minor) return undefined;
    const recent = Number(major) > OLDEST[0] || (Number(major) === OLDEST[0] && Number(minor) >= OLDEST[1]);
    return { executable: path, version: `${major}.${minor}`, recent, server: server === "" ? undefined : server };
}

/**
 * The interpreters on this host that are recent enough, without duplicates.
 *
 * @param first the paths to try before the names on PATH.
 * @param avoid the folders from which no program is started.
 */
export async function* pythons(
    host: Host,
    first: readonly string[],
    avoid: readonly string[] = [],
): AsyncGenerator<Python> {
    const seen = new Set<string>();
    const named = host.windows ? [...NAMES, "py"] : NAMES;
    for (const candidate of [...first, ...named]) {
        const file = first.includes(candidate) ? candidate : await host.which(candidate);
        if (file === undefined || isInside(file, avoid)) continue;
        const python = await askPython(host, file);
        if (python?.recent && !seen.has(python.executable)) {
            seen.add(python.executable);
            yield python;
        }
    }
}
