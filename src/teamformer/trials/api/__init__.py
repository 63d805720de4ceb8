"""What `import teamformer` offers beside the words of the field."""
