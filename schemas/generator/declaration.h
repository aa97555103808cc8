#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "store/yaml_input.h"

// The declaration of a product (`schemas/PRODUCT/v1.yaml`): every field, map, column and word once,
// from which the build writes the structs, their readers and writers, and the field table.
//
//   schema, version   name and version of the product
//   uses              products whose words, groups and maps are used here
//   includes          headers that declare what is written by hand
//   struct            name and about of what holds the whole product; `functions` of it
//   words             enumerations: a word of the file, and what it says to people; where that is
//                     no name in C++, with `enumerator`; where it is said otherwise after what it
//                     is said of ("3 epochs without a position"), with `phrase`; what else a word
//                     has is a list of texts. With `each: MACRO` a macro goes through all of them
//   maps              maps, each a struct: about, fields; `by_hand` where C++ code has the struct
//                     and its codec; `functions` of the struct that C++ code defines
//   groups            columns that several tables have, or that are a struct in the row
//   input             name and about of what holds the whole of an input, which people write and no
//                     program: it has a reader and no writer
//   row, columns      the rows of a table: name and about of their struct, `extends` a product
//                     whose columns come first, `compact` where empty cells take no room
//   fields            the fields outside every map
//   rules             of a map, or of the whole: rules across its keys, which every reader checks
//
// A rule says `when` which keys are what they `must` be: a map each of keys and `given`, `absent`,
// or the words that it may be, by default, too. Or which keys stand `together`, or `one_of` or
// `any_of` which is given, or which two numbers are `ascending`; which `list` has `least` and at
// `most` so many items, or what is `unique` `in` which lists. A key with "/" in front is of the
// document, any other of the map, "columns.time" of one in it. What is wrong is said by the rule's
// keys, or by `because`; what to do by them, or by `remedy`. With `rules_of` a map has those of a
// field of the document, its own keys in the place of that one's.
//
// A field has the keys of a field table (type, unit, required, min, max, values, decimals,
// description). Its type may also be a map, an enumeration, `gps_time`, `satellite` ("G02"),
// `signal` ("1C"), or `speed`, which stands in four units; a `list` is `of` a type, and `item`
// describes what is in it. What is not required is an optional in C++, an empty text or an empty
// list. In inputs a type may be `files` (one name or a list of them), `date`, `utc_time`, `id` or
// `role` (texts that are read strictly) or `file` (the name of one), and what has a `default` is no
// optional. For C++ alone: `member` (where its name is not the field's), `initially` (the value of
// a new struct), `flat` (the members of a map stand beside those of the one it is in), `omit` (the
// value that is left out), `scale` (file over member), `computed` (an expression of the struct,
// written and never read), `apart` (no member: C++ code reads it), `placed` (of a map: the struct
// says where it stands, itself or that field of it), `base` (of an input: the struct of a map is a
// base of the one it is in), `optional` (required in its map, which itself may be absent). A `unit`
// of "*" is that of the field which the map is used for. A column that is never empty says
// `always`.

namespace runcert {

/// A word of an enumeration.
struct DeclaredWord {
    std::string word;         ///< as it stands in files
    std::string enumerator;   ///< the same, where that is no name in C++
    std::string description;  ///< for people
    std::string phrase;       ///< the same after what it is said of, where that differs
    std::map<std::string, std::vector<std::string>> lists = {};  ///< what else it has
};

struct DeclaredWords {
    std::string name;
    std::string about;
    std::vector<DeclaredWord> words;
    std::string each;  ///< the name of a macro that goes through them, where there is one
};

/// A map, a group of columns, or what holds the whole product, with the struct made of it.
struct DeclaredStruct {
    std::string name;
    std::string about;
    std::vector<YamlValue> fields;   ///< a map of each, in the order of the declaration
    std::vector<std::string> names;  ///< their keys
    bool by_hand = false;            ///< C++ code has the struct and its codec
    bool comparable = false;
    bool or_text = false;  ///< a text may stand in its place
    std::string placed;    ///< the field whose place it keeps, "true" for its own; empty for none
    bool compact = false;  ///< a group whose empty cells take no room of their own
    std::vector<std::string> functions = {};  ///< declarations of those that C++ code defines
    std::vector<YamlValue> rules = {};        ///< across its keys
    std::string rules_of;                     ///< the field whose rules it has, too
};

/// A column of a product's table, in the order of the file.
struct DeclaredColumn {
    YamlValue entry;
    const DeclaredStruct* group = nullptr;  ///< that it belongs to
    std::string member;                     ///< of the row, that is the group; empty: a base of it
    bool inherited = false;                 ///< of the row that this one extends
};

class Declaration {
  public:
    /// Reads a declaration, and before it those of the folder `products` that it uses, for their
    /// maps, groups and words.
    Declaration(const std::string& path, const std::filesystem::path& products);

    const YamlValue& source() const { return source_; }
    /// The folder of the file, that headers are included from.
    const std::string& folder() const { return folder_; }
    const DeclaredWords* words(const std::string& name) const;
    const DeclaredStruct* map(const std::string& name) const;
    const DeclaredStruct* group(const std::string& name) const;
    /// Those that the file itself declares, in its order.
    const std::vector<DeclaredWords>& own_words() const { return own_words_; }
    const std::vector<DeclaredStruct>& own_maps() const { return own_maps_; }
    const std::vector<DeclaredStruct>& own_groups() const { return own_groups_; }
    /// All columns: those of the row that this one extends, groups taken apart.
    const std::vector<DeclaredColumn>& columns() const { return columns_; }
    /// Whether it is of an input, which has readers alone.
    bool is_input() const { return source_["input"].exists(); }
    /// The name of the row that this product's extends.
    const std::string& extended_row() const { return extended_row_; }
    /// The fields outside every map.
    const DeclaredStruct& top() const { return top_; }

  private:
    void read(const YamlValue& table, bool own);
    void read_columns(const YamlValue& table, bool inherited);

    YamlValue source_{YamlNode(), ""};
    std::string folder_;
    std::map<std::string, DeclaredWords> words_;
    std::map<std::string, DeclaredStruct> maps_;
    std::map<std::string, DeclaredStruct> groups_;
    std::vector<DeclaredWords> own_words_;
    std::vector<DeclaredStruct> own_maps_;
    std::vector<DeclaredStruct> own_groups_;
    std::vector<DeclaredColumn> columns_;
    std::string extended_row_;
    DeclaredStruct top_;
};

/// The field table of a declaration, with every map written out where it is used: YAML text.
std::string field_table_text(const Declaration& declaration);

/// The header of a declaration: enumerations, structs, and the functions that read and write them.
std::string header_text(const Declaration& declaration);
/// Their definitions.
std::string source_text(const Declaration& declaration);

/// The text in double quotes, as YAML and C++ read them.
std::string in_quotes(std::string_view text);

/// Whether a declaration says yes to this.
bool is_set(const YamlValue& entry, std::string_view key);

/// The name of a field's member: its own; of a speed, which files hold in four units, "NAME_m_s".
std::string member_name(const std::string& field, const YamlValue& entry);
/// The name of a column's member: it ends with the column's unit.
std::string column_member_name(const YamlValue& column);

}  // namespace runcert
