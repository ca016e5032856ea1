"""The words of descriptions, a file a language: the same keys with the same placeholders in each."""
