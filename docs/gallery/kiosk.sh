tangible preflight coins.yaml                          # once, on the machine of the exhibition
tangible feel coins.yaml brick.yaml --each 120 --seconds inf --wait
