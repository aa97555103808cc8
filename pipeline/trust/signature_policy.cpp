#include "trust/signature_policy.h"

#include <algorithm>
#include <map>
#include <set>

#include "trust/signature.h"
#include "trust/ssh_key.h"

namespace runcert {
namespace {

/// Keys by the slot they fill: augmenting paths [Kuhn55].
class Matching {
  public:
    explicit Matching(std::vector<std::set<std::string>> keys_of_slot)
        : keys_of_slot_(std::move(keys_of_slot)), filled_(keys_of_slot_.size(), false) {
        for (std::size_t slot = 0; slot < keys_of_slot_.size(); ++slot) {
            std::set<std::string> tried;
            fill(slot, tried);
        }
        for (const auto& [key, slot] : slot_of_key_)
            filled_[slot] = true;
    }
    bool is_filled(std::size_t slot) const { return filled_[slot]; }

  private:
    bool fill(std::size_t slot, std::set<std::string>& tried) {
        for (const std::string& key : keys_of_slot_[slot]) {
            if (!tried.insert(key).second) continue;
            const auto taken = slot_of_key_.find(key);
            if (taken != slot_of_key_.end() && !fill(taken->second, tried)) continue;
            slot_of_key_[key] = slot;
            return true;
        }
        return false;
    }

    std::vector<std::set<std::string>> keys_of_slot_;
    std::map<std::string, std::size_t> slot_of_key_;
    std::vector<bool> filled_;
};

}  // namespace

std::string key_identity(const Signer& signer) {
    if (signer.key.find(' ') != std::string::npos) return signer.key;
    return ssh_key_text(ssh_key_of(parse_public_key(signer.key, signer.file).key));
}

std::vector<RoleState> fill_roles(const std::vector<RequiredSignatures>& required,
                                  const std::vector<Signer>& signers) {
    std::vector<RoleState> states;
    std::vector<std::set<std::string>> keys_of_slot;
    std::vector<std::size_t> state_of_slot;
    for (const RequiredSignatures& one : required) {
        std::set<std::string> keys;
        for (const Signer& signer : signers)
            if (signer.valid && signer.role == one.role) keys.insert(key_identity(signer));
        keys_of_slot.insert(keys_of_slot.end(), one.count, keys);
        state_of_slot.insert(state_of_slot.end(), one.count, states.size());
        states.push_back({.role = one.role, .needed = one.count});
    }
    const Matching matching(std::move(keys_of_slot));
    for (std::size_t slot = 0; slot < state_of_slot.size(); ++slot)
        if (matching.is_filled(slot)) ++states[state_of_slot[slot]].there;
    return states;
}

}  // namespace runcert
