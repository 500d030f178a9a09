# cmake -DINPUT=file -P write_hash.cmake: writes the SHA-256 of a file, 64 hexadecimal digits, to file.sha256.
file(SHA256 "${INPUT}" hash)
file(WRITE "${INPUT}.sha256" "${hash}\n")
