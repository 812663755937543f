"""Language-model modules (dspy.Module) that write skills and plans, and robot adapters."""
