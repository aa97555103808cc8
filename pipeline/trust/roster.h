#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/common/role_signatures.h"
#include "store/utc_second.h"
#include "trust/signature.h"
#include "trust/ssh_signature.h"

/// Whose signature counts: keys, the roles they may sign in, and when they are valid, in the form
/// of OpenSSH's allowed signers (ssh-keygen(1), ALLOWED SIGNERS). The principals are roles.
namespace runcert {

/// The namespace of a signature in a role: "measurer@runcert". Signatures in minisign's form, which
/// have none, are taken to be of it.
std::string signature_namespace(std::string_view role);

/// Refuses any other text with a Failure at `where`.
void require_role(const std::string& role, const std::string& where);

/// From when on a key no longer counts, and why.
struct Revocation {
    UtcSecond at{};
    std::string reason{};
};

/// One line of a roster.
struct RosterEntry {
    std::string roles{};  ///< patterns, as the line has them
    std::optional<std::string> namespaces{};
    std::optional<UtcSecond> valid_after{};
    std::optional<UtcSecond> valid_before{};  ///< itself still valid, as for ssh-keygen
    SshPublicKey key{};
    std::optional<Revocation> revoked{};    ///< by a line "#runcert revoked"
    std::string who{};                      ///< the line's comment
    std::size_t line = 0;                   ///< from 1
    std::optional<PublicKey::Id> key_id{};  ///< where the key was given in minisign's form

    /// Whether the key may sign in that role, at whatever time.
    bool allows(std::string_view role) const;
    bool is_valid_at(UtcSecond time) const;
};

/// A record that stands, by the body's own word.
struct StandingRecord {
    std::string profile{};      ///< the rule's id
    std::string craft_class{};  ///< pattern
    std::string shown{};        ///< "202.9 km/h"
    double speed_m_s = 0.0;
    std::string source{};
};

struct Roster {
    std::string text{};  ///< as ssh-keygen takes it
    std::vector<RosterEntry> entries{};
    /// What the roster asks for, whatever rules and attempts do: its lines "#runcert signatures
    /// judge=2,measurer", which ssh-keygen takes for comments.
    std::vector<RoleSignatures> required{};
    /// Who closes a run, by its line "#runcert close judge".
    std::string closing_role() const { return closed_by.value_or("board"); }
    std::optional<std::string> closed_by{};
    /// Until when it is in force, by "#runcert valid-until 20280101Z".
    std::optional<UtcSecond> valid_until{};
    /// Who signs the roster that follows it, by "#runcert successor board=2"; none may otherwise.
    std::vector<RoleSignatures> successor{};
    /// The SHA-256 of the one that it follows, by "#runcert follows".
    std::string follows{};
    /// By "#runcert record nalsa land-yacht 202.9 km/h "WHERE"".
    std::vector<StandingRecord> records{};

    /// The record that stands by a rule for a class of craft; nothing where none is named.
    const StandingRecord* record_of(std::string_view profile, std::string_view craft_class) const;
};

/// Reads a roster. Failure with the line where one is malformed, of an unknown type of key or
/// option, or names a certificate authority: certificates are not read here.
Roster parse_roster(std::string_view text, const std::string& where);

/// The roster of a file; none where no file is named. Failures as of parse_roster.
std::optional<Roster> read_roster(const std::string& file);

/// Failure where the roster is no longer in force at that time.
void require_in_force(const Roster& roster, UtcSecond at, const std::string& where);
/// The same of the roster of a file, by the computer's clock; nothing where no file is named.
void require_in_force(const std::string& file);

/// A roster of one public key that may sign at any time in the roles (a pattern, "*" for every
/// one): the text of a file in minisign's or in OpenSSH's form. `who` names it. Failure where the
/// text is neither.
Roster roster_of_public_key(std::string_view text, const std::string& who, const std::string& where,
                            const std::string& roles = "*");

/// Adds the lines of another roster.
void append(Roster& roster, const Roster& more);

/// The line for a key that may sign in one role.
std::string roster_line(const PublicKey& key, const std::string& role, std::string_view who);

}  // namespace runcert
