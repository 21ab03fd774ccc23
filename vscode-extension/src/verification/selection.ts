// SPDX-License-Identifier: Apache-2.0
/** The properties of systems that a user has selected in a tree of tests. */

/** The part of a test that is used: systems have children, properties have none. */
export interface Test<T> {
    readonly id: string;
    readonly parent?: T | undefined;
    readonly children: Iterable<[string, T]>;
}

/** The selected properties in their order, without duplicates. If nothing is selected, all properties. */
export function chosen<T extends Test<T>>(
    all: Iterable<[string, T]>,
    include: readonly T[] | undefined,
    exclude: readonly T[] | undefined,
): T[] {
    const left = new Set(exclude?.map(({ id }) => id));
    const selected = new Map<string, T>();
    const visit = (test: T) => {
        if (left.has(test.id)) return;
        const children = [...test.children];
        if (children.length === 0 && test.parent) selected.set(test.id, test);
        for (const [, child] of children) visit(child);
    };
    for (const test of include ?? [...all].map(([, leaf]) => leaf)) visit(test);
    return [...selected.values()];
}
