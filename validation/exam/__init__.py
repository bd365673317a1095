"""The exam: scenes put to any code, and the judgement of the traces it answers with."""
