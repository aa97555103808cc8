// A program of the build: `runcert_declare DECLARATION PRODUCTS OUTPUT` writes what a product's
// declaration stands for: OUTPUT.h and OUTPUT.cpp, its structs with their readers and writers, and
// OUTPUT.yaml, its field table.

#include <fmt/format.h>

#include <exception>

#include "schemas/generator/declaration.h"
#include "store/atomic_file.h"

int main(int argc, char** argv) {
    try {
        if (argc != 4) throw std::invalid_argument("expected DECLARATION PRODUCTS OUTPUT");
        const runcert::Declaration declaration(argv[1], argv[2]);
        const std::string output = argv[3];
        runcert::write_if_changed(output + ".yaml", runcert::field_table_text(declaration));
        runcert::write_if_changed(output + ".h", runcert::header_text(declaration));
        runcert::write_if_changed(output + ".cpp", runcert::source_text(declaration));
        return 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "runcert_declare: {}\n", error.what());
        return 1;
    }
}
