// SPDX-License-Identifier: Apache-2.0
/**
 * In what surroundings programs are started, so that a workspace cannot have its own code run by lying there.
 *
 * - Python looks for modules in the working folder unless it is told not to (`-I`), and in what PYTHONPATH names: an empty
 *   or relative entry there means the working folder, too.
 * - Windows looks for programs and libraries in the working folder.
 */

import * as path from "node:path";

/** A folder that is always there and that no workspace can put anything into: that of the running editor. */
export function safeFolder(): string {
    return path.dirname(process.execPath);
}

/** Variables of the environment in place of those in `environment` that could have code of the working folder run. */
export function safeVariables(environment: NodeJS.ProcessEnv): Record<string, string> {
    const safe: Record<string, string> = { PYTHONSAFEPATH: "1" };
    const named = environment["PYTHONPATH"];
    if (named !== undefined) {
        safe["PYTHONPATH"] = named
            .split(path.delimiter)
            .filter((each) => path.isAbsolute(each))
            .join(path.delimiter);
    }
    return safe;
}

/** Whether a file lies in one of these folders. */
export function isInside(file: string, folders: readonly string[]): boolean {
    return folders.some((folder) => {
        const relative = path.relative(folder, file);
        return relative === "" || (!relative.startsWith("..") && !path.isAbsolute(relative));
    });
}
