#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/common/header.h"
#include "schemas/common/product_files.h"
#include "schemas/profile/profile.h"
#include "store/atomic_file.h"

namespace runcert {

/// A table of the run folder that is gone through row by row, once, in memory that does not grow
/// with it.
template <class Table>
class RowsOfFile {
  public:
    RowsOfFile(std::unique_ptr<FileView> view, Table table)
        : view_(std::move(view)), table_(std::move(table)) {}

    /// The table without its rows.
    const auto& head() const { return table_.head; }

    /// Reads the next row, as RowReader.
    bool next(typename Table::Row& row) {
        if (++rows_ % rows_to_release == 0) view_->release(table_.rows.offset());
        return table_.rows.next(row);
    }

    /// Reads all rows that are left, each of which is checked thereby.
    void read_to_end() {
        for (typename Table::Row row; next(row);) {
        }
    }

    /// Gives each of the rows, from the current one on, to `look`, without stepping over them.
    template <class Look>
    void look_ahead(const Look& look) const {
        auto ahead = table_.rows;
        for (typename Table::Row row; ahead.next(row);)
            look(row);
    }

  private:
    static constexpr std::size_t rows_to_release = std::size_t{1} << 15;

    std::unique_ptr<FileView> view_;
    Table table_;
    std::size_t rows_ = 0;
};

/// What surrounds a stage: its attempt, its run folder, and the book of what it read.
///
/// Every file read is hashed. Where the header of one file states the hash of another that is read
/// too, the two must agree; a mismatch is a Failure.
class StageRun {
  public:
    /// Reads and checks the attempt. The run folder is created if it is missing.
    StageRun(std::string stage, const std::filesystem::path& attempt_file,
             std::filesystem::path run_dir);

    /// Of a stage that says what it reads of the attempt (`reads_part`), that part.
    const Attempt& attempt() const { return attempt_; }
    const std::filesystem::path& run_dir() const { return run_dir_; }
    const std::filesystem::path& attempt_path() const { return attempt_path_; }
    const std::string& attempt_text() const { return attempt_text_; }

    /// The profiles that the attempt claims, its figures in place of theirs. What the stage reads
    /// of them is named in its header.
    std::vector<Profile> read_profiles();

    /// The attempt as an input of the stage; a stage that uses more of it than its parameters calls
    /// this to have it named in its header.
    void note_attempt();
    /// What the stage uses in place of the attempt's parameters of its name.
    void use_parameters(OpaqueJson parameters) {
        parameters_ = std::move(parameters);
        read_ = {};
    }
    /// Notes bytes that do not come from the run folder's products.
    void note_input(const std::string& role, const std::string& file, std::string_view bytes,
                    const std::string& original = {});
    void note_input(const std::string& role, const std::string& file, const FileView& view,
                    const std::string& original = {});

    /// Notes a file of the run folder, without keeping its bytes in memory.
    void note_file(const std::string& role, const std::string& file,
                   const std::string& original = {});
    /// All that was noted, in the order of noting.
    const std::vector<InputFile>& inputs() const { return inputs_; }

    /// The bytes of a file of the run folder, noted as an input.
    std::string read_text(const std::string& role, const std::string& file);

    /// A product of the run folder: `reader(text, where)` returns it, with its `header`.
    template <class Reader>
    auto read(const std::string& role, const std::string& file, Reader reader) {
        const FileView view = view_file(role, file);
        auto product = reader(view.bytes(), (run_dir_ / file).string());
        note_expected(file, product.header);
        return product;
    }

    /// The product of a receiver, in its role.
    template <class Reader>
    auto read(const ProductFile& product, const Receiver& receiver, Reader reader) {
        return read(std::string(product.name), file_of(product, receiver), reader);
    }

    /// A product that is a table, to be gone through row by row: `open_table(text, where)` gives
    /// its head and the reader of its rows (OpenTable).
    template <class Open>
    auto open(const std::string& role, const std::string& file, Open open_table) {
        auto view = std::make_unique<FileView>(view_file(role, file));
        auto table = open_table(view->bytes(), (run_dir_ / file).string());
        note_expected(file, table.head.header);
        return RowsOfFile(std::move(view), std::move(table));
    }

    template <class Open>
    auto open(const ProductFile& product, const Receiver& receiver, Open open_table) {
        return open(std::string(product.name), file_of(product, receiver), open_table);
    }

    /// The verdict, which is of the whole run.
    template <class Reader>
    auto read(const ProductFile& product, Reader reader) {
        return read(product, attempt_.receivers.front(), reader);
    }

    /// From now on, and of what was read, each input that the header names must have its hash
    /// there. `file` is whose header it is. Failure where one has another.
    void note_expected(const std::string& file, const Header& header);

    /// The name of a product in the run folder.
    std::string file_of(const ProductFile& product, const Receiver& receiver) const;

    /// The header of what the stage writes: the inputs noted so far, and the stage's parameters.
    Header header() const;

    /// Writes a product into the run folder, whole or not at all.
    void write(const std::string& file, std::string_view text) const;
    /// The same of an open file, piece by piece.
    void write(const std::string& file, const FileView& view) const;

    void write(const ProductFile& product, const Receiver& receiver, std::string_view text) const {
        write(file_of(product, receiver), text);
    }

    /// Adds to what the stage says on standard output when it is done.
    void say(std::string line) { said_.push_back(std::move(line)); }
    const std::vector<std::string>& said() const { return said_; }

  private:
    struct ExpectedHash {
        std::string sha256;
        std::string stated_in;
    };
    FileView view_file(const std::string& role, const std::string& file);
    void note(const InputFile& input);
    void check_expected(const std::string& file, const std::string& sha256) const;

    std::string stage_;
    std::filesystem::path attempt_path_;
    std::filesystem::path run_dir_;
    std::string attempt_text_;
    Attempt attempt_;
    OpaqueJson parameters_;
    OpaqueJson read_;  ///< of the attempt, beside these
    std::vector<InputFile> inputs_;
    std::map<std::string, ExpectedHash> expected_;
    std::vector<std::string> said_;
};

/// A run folder as a program reads it that writes nothing there. What report.json names, where
/// there is one, must have the hash that stands there. Failure where there is no such folder.
StageRun open_run(const std::string& program, const std::filesystem::path& run_dir);

/// The receiver of that id, the first where it is empty. Failure (at "--receiver") where there is
/// none.
const Receiver& receiver_of(const Attempt& attempt, const std::string& id);

}  // namespace runcert
