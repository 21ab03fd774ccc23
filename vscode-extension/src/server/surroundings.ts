// SPDX-License-Identifier: Apache-2.0
/**
 * The working folder and environment variables of started programs, so that they never execute code of the workspace.
 *
 * - Python searches for modules in the working folder, unless started with `-I`, and in the entries of PYTHONPATH. An
 *   empty or relative entry also refers to the working folder.
 * - Windows searches for programs and libraries in the working folder.
 */

import * as path from "node:path";

/** A folder that always exists and into which no workspace can write: that of the running editor. */
export function safeFolder(): string {
    return path.dirname(process.execPath);
}

/** Replacements for the variables in `environment` that could cause code of the working folder to be executed. */
export function safeVariables(environment: NodeJS.ProcessEnv): Record<string, string> {
    const safe: Record<string, string> = { PYTHONSAFEPATH: "1" };
    const named = environment["PYTHONPATH"];
    if (named !== undefined) {
        safe["PYTHONPATH"] = named
            .split(path.delimiter)
            .filter((folder) => path.isAbsolute(folder))
            .join(path.delimiter);
    }
    return safe;
}

/** Whether a file is in one of these folders. */
export function isInside(file: string, folders: readonly string[]): boolean {
    return folders.some((folder) => {
        const relative = path.relative(folder, file);
        return relative === "" || (!relative.startsWith("..") && !path.isAbsolute(relative));
    });
}
