/* SPDX-License-Identifier: MIT
 * Can a program that was never linked with hemibake call it? Opens the library that its argument names.
 */
#include <hemibake/plugin_table.h>

#include <dlfcn.h>
#include <stdio.h>

int main(int argc, char **argv) {
    void *library = argc == 2 ? dlopen(argv[1], RTLD_NOW | RTLD_LOCAL) : NULL;
    const hemi_plugin *hemi = library ? dlsym(library, HEMI_PLUGIN_SYMBOL) : NULL;
    hemi_context *context = NULL;
    if (!hemi || hemi->abi != HEMI_PLUGIN_ABI || hemi->struct_size < sizeof *hemi) return 1;
    if (hemi->context_create(NULL, &context) != HEMI_OK) return 1;
    hemi->context_destroy(context);
    printf("%s\n", hemi->version());
    return dlclose(library) == 0 ? 0 : 1;
}
