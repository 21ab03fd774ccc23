// SPDX-License-Identifier: Apache-2.0
/** The texts about the server: for each state and each failure, a description and the possible actions. */

import { l10n } from "vscode";
import { OLDEST } from "../server/python";
import type { Step } from "../server/environment";
import type { Failure, Origin } from "../server/server";
import type { State } from "../server/supervisor";

export type Command =
    | "as2fm.install"
    | "as2fm.selectInterpreter"
    | "as2fm.restart"
    | "as2fm.showLog"
    | "as2fm.openServerSetting"
    | "as2fm.getPython";

export interface Action {
    readonly title: string;
    readonly command: Command;
}

export interface Told {
    readonly severity: "quiet" | "warning" | "error";
    /** A few words for the status bar. */
    readonly short: string;
    /** One or two sentences: what is wrong and what to do. */
    readonly long: string;
    readonly actions: readonly Action[];
}

const restart = (): Action => ({ title: l10n.t("Restart"), command: "as2fm.restart" });
const tryAgain = (): Action => ({ title: l10n.t("Try Again"), command: "as2fm.restart" });
const log = (): Action => ({ title: l10n.t("Show Log"), command: "as2fm.showLog" });
const install = (): Action => ({ title: l10n.t("Install"), command: "as2fm.install" });
const installAgain = (): Action => ({ title: l10n.t("Install Again"), command: "as2fm.install" });
const retryInstall = (): Action => ({ title: l10n.t("Try Again"), command: "as2fm.install" });
const select = (): Action => ({ title: l10n.t("Select Interpreter"), command: "as2fm.selectInterpreter" });
const setting = (): Action => ({ title: l10n.t("Open Setting"), command: "as2fm.openServerSetting" });
const getPython = (): Action => ({ title: l10n.t("Get Python"), command: "as2fm.getPython" });

export function tellState(state: State): Told {
    switch (state.kind) {
        case "stopped":
            return { severity: "quiet", short: l10n.t("stopped"), long: l10n.t("Stopped."), actions: [restart()] };
        case "searching":
            return quiet(l10n.t("searching"), l10n.t("Searching for the language server."));
        case "installing":
            return quiet(l10n.t("installing"), tellStep(state.step));
        case "starting":
            return quiet(l10n.t("starting"), l10n.t("Starting {0}.", state.server.command));
        case "running": {
            const { version, origin, command } = state.server;
            const long = l10n.t("Version {0}, {1}: {2}", version, tellOrigin(origin), command);
            return { severity: "quiet", short: version, long, actions: [restart(), log(), select()] };
        }
        case "failed":
            return tellFailure(state.failure);
    }
}

export function tellStep(step: Step): string {
    switch (step) {
        case "python":
            return l10n.t("Searching for Python.");
        case "venv":
            return l10n.t("Creating a private Python environment.");
        case "packages":
            return l10n.t("Installing the language server and the packages that it needs.");
    }
}

export function tellOrigin(origin: Origin): string {
    switch (origin) {
        case "setting":
            return l10n.t("from the setting as2fm.server.path");
        case "python":
            return l10n.t("from the Python environment");
        case "path":
            return l10n.t("from PATH");
        case "private":
            return l10n.t("from the extension's own environment");
    }
}

function tellFailure(failure: Failure): Told {
    const oldest = OLDEST.join(".");
    switch (failure.kind) {
        case "no-server":
            return {
                severity: "warning",
                short: l10n.t("not installed"),
                long: l10n.t(
                    "The language server for HL-SCXML is not installed yet. It can be installed in a private Python environment, separate from everything else on this machine.",
                ),
                actions: [install(), select(), log()],
            };
        case "configured-server":
            return error(
                l10n.t("server not usable"),
                l10n.t(
                    "The setting as2fm.server.path is {0}, which cannot be started as a language server. Correct the setting, or clear it to let the extension find one.",
                    failure.path,
                ),
                [setting(), tryAgain(), log()],
            );
        case "no-python":
            return error(
                l10n.t("no Python"),
                l10n.t(
                    "The language server needs Python {0} or newer, and there is none on PATH. Install it (on Debian and Ubuntu: apt install python3 python3-venv), or select another interpreter.",
                    oldest,
                ),
                [getPython(), select(), retryInstall()],
            );
        case "no-venv":
            return error(
                l10n.t("no environment"),
                l10n.t(
                    "Python {0} could not create an environment. On Debian and Ubuntu, install its module venv with: apt install python3-venv. Then try again.",
                    failure.python,
                ),
                [retryInstall(), select(), log()],
            );
        case "no-packages":
            return error(
                l10n.t("not installed"),
                l10n.t(
                    "pip could not download the packages that the language server needs. They come from the index in pip's configuration: check the network, the proxy and pip's index-url. Without an index, install as2fm-lsp in another way and set as2fm.server.path.",
                ),
                [retryInstall(), setting(), log()],
            );
        case "start":
            return error(
                l10n.t("did not start"),
                l10n.t("The language server did not start: {0}", lastLine(failure.detail)),
                [tryAgain(), ...(failure.server.origin === "private" ? [installAgain()] : [select()]), log()],
            );
        case "crashes":
            return error(
                l10n.t("stopped"),
                l10n.t(
                    "The language server ended unexpectedly {0} times within three minutes and was not restarted. See its log for details.",
                    failure.count,
                ),
                [restart(), log()],
            );
        case "internal":
            return error(l10n.t("failed"), l10n.t("The extension failed: {0}", lastLine(failure.detail)), [
                tryAgain(),
                log(),
            ]);
    }
}

function quiet(short: string, long: string): Told {
    return { severity: "quiet", short, long, actions: [] };
}

function error(short: string, long: string, actions: readonly Action[]): Told {
    return { severity: "error", short, long, actions };
}

function lastLine(text: string): string {
    return text.trim().split("\n").at(-1) ?? "";
}
