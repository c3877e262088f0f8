// Certificates for a server that phones on the same network shall reach: browsers give their sensors only to https.
#pragma once

#include <span>
#include <string>

#include "apps/server/server.h"

namespace carom::server {

/// A new key and a certificate that it signed itself, for this machine's names and addresses and those of `names`.
/// Browsers warn of it once: who made it is nobody they know.
core::Result<TlsIdentity> make_identity(std::span<const std::string> names);

/// What lies in `folder` (tls-certificate.pem, tls-key.pem), or a new one put there where nothing lies, where a name is
/// missing in it or where its time is nearly over. Empty folder: the user's own ($XDG_CONFIG_HOME/carom,
/// ~/.config/carom).
core::Result<TlsIdentity> user_identity(std::span<const std::string> names, const std::string& folder = {});

/// Files that somebody else made. Errors name the file and what is wrong with it.
core::Result<TlsIdentity> read_identity(const std::string& certificate_file, const std::string& key_file);

/// SHA-256 of the certificate in pairs of hex digits, as browsers show it.
core::Result<std::string> fingerprint(const TlsIdentity& identity);

}  // namespace carom::server
