"""The measures of answers: rows about participants and conditions, and what each kind of answer yields."""
