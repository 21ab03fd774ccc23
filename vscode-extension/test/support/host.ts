// SPDX-License-Identifier: Apache-2.0
import type { Host } from "../../src/server/host";
import type { Ended, RunOptions } from "../../src/server/run";

type Program = (args: readonly string[]) => Partial<Ended>;

/** A host with these programs, by their paths; those in /bin are on PATH. Records the executed programs. */
export class FakeHost implements Host {
    readonly windows = false;
    readonly ran: string[] = [];
    readonly files = new Map<string, string>();

    constructor(private readonly programs: Readonly<Record<string, Program>>) {}

    run(command: string, args: readonly string[], { onOutput }: RunOptions = {}): Promise<Ended> {
        this.ran.push([command, ...args].join(" "));
        const program = this.programs[command];
        const ended = program ? program(args) : { status: null, err: `spawn ${command} ENOENT` };
        const whole = { status: 0, out: "", err: "", ...ended };
        onOutput?.(whole.out + whole.err);
        return Promise.resolve(whole);
    }

    which(name: string): Promise<string | undefined> {
        return Promise.resolve(`/bin/${name}` in this.programs ? `/bin/${name}` : undefined);
    }

    read(file: string): Promise<string | undefined> {
        return Promise.resolve(this.files.get(file));
    }

    write(file: string, text: string): Promise<void> {
        this.files.set(file, text);
        return Promise.resolve();
    }

    remove(folder: string): Promise<void> {
        for (const file of this.files.keys()) if (file.startsWith(`${folder}/`)) this.files.delete(file);
        return Promise.resolve();
    }

    list(folder: string): Promise<readonly string[]> {
        const inside = [...this.files.keys()].filter((file) => file.startsWith(`${folder}/`));
        return Promise.resolve([...new Set(inside.map((file) => file.slice(folder.length + 1).split("/")[0] ?? ""))]);
    }
}

/** A Python that answers what it is asked; `server` is what is installed for it. */
export function python(executable: string, version = "3.11", server = ""): Program {
    return (args) =>
        args.includes("-c") ? { out: [executable, ...version.split("."), server].join("\n") } : { status: 1 };
}

/** A program that is, or is not, the language server. */
export function server(version: string): Program {
    return (args) => (args[0] === "--version" ? { out: `as2fm-lsp ${version}\n` } : { status: 2 });
}
